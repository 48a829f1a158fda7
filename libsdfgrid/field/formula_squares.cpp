#include "sdfgrid/field/formula_squares.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace sdfgrid {

using ops::FormulaOp;

std::size_t start_of_last(std::span<const FormulaStep> code) {
  int needed = 1;
  std::size_t i = code.size();
  while (needed > 0) {
    --i;
    needed += ops::operands(code[i].op) - 1;
  }
  return i;
}

namespace {

using CodeSpan = std::span<const FormulaStep>;

// The code of the two values that the last operation takes.
std::pair<CodeSpan, CodeSpan> both_of(CodeSpan code) {
  const CodeSpan values = code.first(code.size() - 1);
  const std::size_t second = start_of_last(values);
  return {values.first(second), values.subspan(second)};
}

// The code of a value whose square this is, if it shows.
std::optional<FormulaSteps> root_of(CodeSpan code) {
  const FormulaStep last = code.back();
  if (last.op == FormulaOp::constant && last.number >= 0) {
    return FormulaSteps{{FormulaOp::constant, std::sqrt(last.number)}};
  }
  if (last.op == FormulaOp::raise && last.number > 0 && std::fmod(last.number, 2) == 0) {
    FormulaSteps root = FormulaSteps(code.begin(), code.end());
    root.back().number /= 2;
    if (root.back().number == 1) root.pop_back();
    return root;
  }
  if (last.op != FormulaOp::multiply && last.op != FormulaOp::divide) return {};
  const auto [a, b] = both_of(code);
  if (last.op == FormulaOp::multiply && std::ranges::equal(a, b))
    return FormulaSteps(a.begin(), a.end());
  std::optional<FormulaSteps> root = root_of(a);
  const std::optional<FormulaSteps> other = root_of(b);
  if (!root || !other) return {};
  root->insert(root->end(), other->begin(), other->end());
  root->push_back(last);
  return root;
}

}  // namespace

bool roots_of_squares(std::span<const FormulaStep> code, std::vector<FormulaSteps>& roots) {
  if (code.back().op == FormulaOp::add) {
    const auto [a, b] = both_of(code);
    return roots_of_squares(a, roots) && roots_of_squares(b, roots);
  }
  std::optional<FormulaSteps> root = root_of(code);
  if (root) roots.push_back(std::move(*root));
  return root.has_value();
}

std::optional<FormulaSteps> without_sign(CodeSpan a, CodeSpan b) {
  if (a.back().op == FormulaOp::sign_of) std::swap(a, b);
  if (b.back().op != FormulaOp::sign_of) return {};
  const CodeSpan u = b.first(b.size() - 1);
  FormulaSteps absolute(u.begin(), u.end());
  absolute.push_back({FormulaOp::absolute, 0});
  if (std::ranges::equal(a, u)) return absolute;
  if (a.back().op == FormulaOp::multiply) {  // of more factors one is enough
    const auto [first, second] = both_of(a);
    for (const auto& [with, rest] : {std::pair(second, first), std::pair(first, second)}) {
      std::optional<FormulaSteps> product = without_sign(with, b);
      if (!product) continue;
      product->insert(product->end(), rest.begin(), rest.end());
      product->push_back({FormulaOp::multiply, 0});
      return product;
    }
    return {};
  }
  const FormulaStep power = a.back();
  const bool raised = power.op == FormulaOp::raise || power.op == FormulaOp::power_of;
  if (!raised || power.number < 2) return {};
  const CodeSpan base = a.first(a.size() - 1);
  const bool of_absolute = std::ranges::equal(base, absolute);
  if (!of_absolute && !std::ranges::equal(base, u)) return {};
  FormulaSteps product(base.begin(), base.end());
  if (power.number != 2) product.push_back({power.op, power.number - 1});
  if (of_absolute) {
    product.insert(product.end(), u.begin(), u.end());
  } else {
    product.insert(product.end(), absolute.begin(), absolute.end());
  }
  product.push_back({FormulaOp::multiply, 0});
  return product;
}

}  // namespace sdfgrid
