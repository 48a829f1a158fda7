// tests/field/brute_force.h: surfaces from nothing but membership: a lattice whose edges cross
// them, bisected.
#pragma once

#include <random>

#include "field/solids.h"

Vec random_direction(std::mt19937& random);
Vec random_point(const sdfgrid::Box& box, std::mt19937& random);

// The place between two points on different sides, within 1e-7 of their distance.
Vec crossing(const Inside& inside, Vec a, Vec b);

// Points of the surface all over a box: where edges of a lattice have their ends on different
// sides.
std::vector<Vec> surface_points(const Inside& inside, const sdfgrid::Box& box);

// The distance from p to the nearest point of the surface that is found: from the nearest of those
// given, all around it, closer and closer. Never too small.
double nearest_found(const Inside& inside, const std::vector<Vec>& surface, const Vec& p,
                     std::mt19937& random);

// Whether both sides are found within a distance of a point.
bool both_sides_near(const Inside& inside, const Vec& p, double distance, std::mt19937& random);
