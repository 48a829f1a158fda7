// field/op_list.h: all ops, by family (internal to field/). A new op is added to the list at the
// end of its family's header; everything else follows from here.
#pragma once

#include <tuple>

#include "sdfgrid/field/blends.h"
#include "sdfgrid/field/combinations.h"
#include "sdfgrid/field/displace.h"
#include "sdfgrid/field/domains.h"
#include "sdfgrid/field/folds.h"
#include "sdfgrid/field/formulas.h"
#include "sdfgrid/field/leaves_basic.h"
#include "sdfgrid/field/leaves_fractal.h"
#include "sdfgrid/field/leaves_round.h"
#include "sdfgrid/field/leaves_soft.h"
#include "sdfgrid/field/ranges.h"
#include "sdfgrid/field/region.h"
#include "sdfgrid/field/warps.h"

namespace sdfgrid::ops {

// The place of a family is part of an op's number: kFamilySize * place + place within the family.
using Families =
    std::tuple<Combinations, Blends, Ranges, Displacements, Domains, Folds, Warps, MoreWarps,
               BasicLeaves, RoundLeaves, SoftLeaves, FractalLeaves, TerrainLeaves, Formulas>;

// Calls visit.template operator()<Op>(number) for each op.
template <class Visit, class... Op>
constexpr void each_of(OpList<Op...>, int first, const Visit& visit) {
  int place = 0;
  (visit.template operator()<Op>(first + place++), ...);
}
template <class Visit>
constexpr void each_op(const Visit& visit) {
  int family = 0;
  std::apply([&](auto... list) { (each_of(list, 64 * family++, visit), ...); }, Families{});
}

}  // namespace sdfgrid::ops
