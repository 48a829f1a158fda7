// tests/field/file_leaves.h: the leaves that come from files, as examples beside those of the ops.
#pragma once

#include "field/examples.h"

std::vector<Example> file_leaves();
