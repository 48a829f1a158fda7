// A recursive descent over the formula that writes postfix code, constants folded as they meet.
#include "sdfgrid/field/formula.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "sdfgrid/core/error.h"
#include "sdfgrid/field/formula_squares.h"

namespace sdfgrid {
namespace {

using ops::FormulaOp;
using Code = FormulaStep;
using Codes = FormulaSteps;
using CodeSpan = std::span<const Code>;

constexpr int kDepth = 64;             // of parentheses and signs
constexpr std::size_t kLength = 4096;  // of a formula and of its code

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

class Parser {
 public:
  Parser(std::string_view text, double t, std::string_view variables)
      : text_(text), t_(t), variables_(variables) {}

  Codes parse() {
    if (text_.size() > kLength) fail(0, fmt::format("longer than {} characters", kLength));
    sum();
    skip();
    if (at_ < text_.size()) {
      fail(at_, text_[at_] == ')' ? "there is no parenthesis to close"
                                  : "expected an operator or the end");
    }
    return std::move(code_);
  }

  // The formula again with a caret under character `place`; no longer than a line.
  [[noreturn]] void fail(std::size_t place, const std::string& what) const {
    constexpr std::size_t kBefore = 50;
    const std::size_t first = place > kBefore ? place - kBefore : 0;
    std::string shown(text_.substr(first, kBefore + 30));
    for (char& c : shown) {
      if (c < ' ' || c > '~') c = '?';
    }
    throw Error(ErrorKind::input, fmt::format("formula: {} at character {}\n  {}\n  {}^", what,
                                              place + 1, shown, std::string(place - first, ' ')));
  }

 private:
  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) {
      ++at_;
    }
  }
  bool take(std::string_view token) {
    skip();
    if (!text_.substr(at_).starts_with(token)) return false;
    at_ += token.size();
    return true;
  }
  bool next_is(std::string_view token) {
    skip();
    return text_.substr(at_).starts_with(token);
  }

  void sum() {
    product();
    for (;;) {
      const std::size_t place = at_;
      if (take("+")) {
        product();
        two(FormulaOp::add, place);
      } else if (take("-")) {
        product();
        two(FormulaOp::subtract, place);
      } else {
        return;
      }
    }
  }

  void product() {
    signed_power();
    for (;;) {
      const std::size_t place = at_;
      if (!next_is("**") && take("*")) {
        signed_power();
        multiply(place);
      } else if (take("/")) {
        signed_power();
        two(FormulaOp::divide, place);
      } else {
        return;
      }
    }
  }

  void signed_power() {
    const Level level(*this);
    const std::size_t place = at_;
    if (take("-")) {
      signed_power();
      one(FormulaOp::negative, place);
    } else if (take("+")) {
      signed_power();
    } else {
      power();
    }
  }

  void power() {
    atom();
    const std::size_t place = at_;
    if (take("**") || take("^")) {
      signed_power();
      raise(place);
    }
  }

  void atom() {
    skip();
    const std::size_t place = at_;
    if (at_ == text_.size()) fail(place, "the formula ends where a number or name should follow");
    if (take("(")) {
      sum();
      close(place);
    } else if (is_digit(text_[at_]) || text_[at_] == '.') {
      number();
    } else if (is_letter(text_[at_])) {
      name();
    } else {
      fail(place, "expected a number, a name or a parenthesis");
    }
  }

  void close(std::size_t opened) {
    if (!take(")")) fail(opened, "this parenthesis is never closed");
  }

  void number() {
    double value = 0;
    const char* const first = text_.data() + at_;
    const auto result = std::from_chars(first, text_.data() + text_.size(), value);
    if (result.ec != std::errc{} || !std::isfinite(static_cast<float>(value))) {
      fail(at_, "not a number in range");
    }
    emit({FormulaOp::constant, value}, at_);
    at_ += static_cast<std::size_t>(result.ptr - first);
  }

  void name() {
    const std::size_t place = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    const std::string_view word = text_.substr(place, at_ - place);
    if (next_is("(")) return call(word, place);
    if (word == "x" || word == "y" || word == "z") return variable(word[0], place);
    if (word == "t") return emit({FormulaOp::constant, t_}, place);
    if (word == "pi") return emit({FormulaOp::constant, std::numbers::pi}, place);
    if (word == "e") return emit({FormulaOp::constant, std::numbers::e}, place);
    fail(place, fmt::format("unknown name `{}`; known are x, y, z, t, pi, e and functions{}",
                            shortened(word), known_functions()));
  }

  void variable(char name, std::size_t place) {
    if (variables_.find(name) == std::string_view::npos) {
      fail(place, fmt::format("`{}` has no value here ({})", name,
                              variables_.empty() ? "a number is wanted"
                                                 : fmt::format("the variable is {}", variables_)));
    }
    emit({static_cast<FormulaOp>(static_cast<int>(FormulaOp::x) + name - 'x'), 0}, place);
  }

  static std::string shortened(std::string_view word) { return std::string(word.substr(0, 40)); }
  static std::string known_functions() {
    std::string all;
    for (const FormulaFunction& f : formula_functions()) all += fmt::format(" {}", f.name);
    return all;
  }

  void call(std::string_view word, std::size_t place) {
    const FormulaFunction* function = nullptr;
    for (const FormulaFunction& f : formula_functions()) {
      if (f.name == word) function = &f;
    }
    if (function == nullptr) {
      fail(place,
           fmt::format("unknown function `{}`; known are{}", shortened(word), known_functions()));
    }
    const std::size_t opened = at_;
    take("(");
    const std::size_t first = code_.size();
    int arguments = 0;
    do {
      sum();
      if (++arguments >= 2 && function->most > 2) {
        two(word == "min" ? FormulaOp::minimum : FormulaOp::maximum, place);
      }
    } while (take(","));
    close(opened);
    if (arguments < function->least || arguments > function->most) {
      fail(place, fmt::format("`{}` takes {} arguments, not {}", word, function->least, arguments));
    }
    if (function->most <= 2) apply(word, place, first);
  }

  // The functions that are one operation, and those made of several.
  void apply(std::string_view word, std::size_t place, std::size_t first) {
    constexpr std::pair<std::string_view, FormulaOp> kDirect[] = {
        {"abs", FormulaOp::absolute},   {"exp", FormulaOp::exponential},
        {"log", FormulaOp::logarithm},  {"sin", FormulaOp::sine},
        {"cos", FormulaOp::cosine},     {"acos", FormulaOp::arccosine},
        {"tan", FormulaOp::tangent},    {"asin", FormulaOp::arcsine},
        {"floor", FormulaOp::floor_of}, {"sign", FormulaOp::sign_of}};
    for (const auto& [name, op] : kDirect) {
      if (name == word) return one(op, place);
    }
    if (word == "sqrt") return root(place);
    if (word == "atan2") return two(FormulaOp::arctangent2, place);
    if (word == "mod") return two(FormulaOp::modulo, place);
    if (word == "pow") return raise(place);
    const auto constant = [&](double v) { emit({FormulaOp::constant, v}, place); };
    const auto argument =
        [&, code = Codes(code_.begin() + static_cast<std::ptrdiff_t>(first), code_.end())] {
          for (const Code& c : code) emit(c, place);
        };
    if (word == "atan") {
      constant(1);
      two(FormulaOp::arctangent2, place);
    } else {
      hyperbolic(word, place, argument);
    }
  }

  // The root of a sum of two or three squares is the length that it is: its slope has a bound at 0,
  // where that of the root has none.
  void root(std::size_t place) {
    const std::size_t first = start_of_last(code_);
    std::vector<Codes> terms;
    const bool constant = code_.back().op == FormulaOp::constant;
    if (constant || !roots_of_squares(CodeSpan(code_).subspan(first), terms) || terms.size() > 3) {
      return one(FormulaOp::root, place);
    }
    code_.resize(first);
    --stack_;
    for (const Codes& term : terms) {
      for (const Code& c : term) emit(c, place);
    }
    constexpr FormulaOp kLengths[] = {FormulaOp::absolute, FormulaOp::length_of_two,
                                      FormulaOp::length_of_three};
    emit({kLengths[terms.size() - 1], 0}, place);
  }

  // sinh, cosh and tanh from e^a and e^-a.
  template <class Argument>
  void hyperbolic(std::string_view word, std::size_t place, const Argument& argument) {
    const auto half = [&](FormulaOp join) {
      one(FormulaOp::exponential, place);
      argument();
      one(FormulaOp::negative, place);
      one(FormulaOp::exponential, place);
      two(join, place);
    };
    half(word == "cosh" ? FormulaOp::add : FormulaOp::subtract);
    if (word == "tanh") {
      argument();
      half(FormulaOp::add);
      two(FormulaOp::divide, place);
    } else {
      emit({FormulaOp::constant, 0.5}, place);
      two(FormulaOp::multiply, place);
    }
  }

  // The uppermost value but one to the power above it: a whole constant is a product.
  void raise(std::size_t place) {
    const Code exponent = code_.back();
    const bool constant = exponent.op == FormulaOp::constant;
    const bool whole =
        exponent.number == std::floor(exponent.number) && std::fabs(exponent.number) <= 64;
    const bool of_constant = code_[code_.size() - 2].op == FormulaOp::constant;
    const bool root_only = exponent.number == 0.5;
    if (!constant || !(whole || root_only || (exponent.number > 0 && !of_constant))) {
      return two(FormulaOp::power, place);
    }
    code_.pop_back();
    --stack_;
    if (root_only) return root(place);
    one(whole ? FormulaOp::raise : FormulaOp::power_of, place, exponent.number);
  }

  void emit(const Code& code, std::size_t place) {
    stack_ += 1 - ops::operands(code.op);
    if (stack_ > ops::kFormulaStack) fail(place, "too many open operations; simplify the formula");
    if (code_.size() >= kLength) fail(place, "too many operations; simplify the formula");
    code_.push_back(code);
  }

  void one(FormulaOp op, std::size_t place, double number = 0) {
    if (code_.back().op == FormulaOp::constant) {
      const double a = code_.back().number;
      const double value = op == FormulaOp::logarithm
                               ? std::log(a)
                               : ops::apply_one<double>(op, a, static_cast<float>(number));
      code_.back().number = checked(value, place);
    } else {
      emit({op, number}, place);
    }
  }
  void multiply(std::size_t place) {
    const std::size_t second = start_of_last(code_);
    const std::size_t first = start_of_last(CodeSpan(code_).first(second));
    const CodeSpan both = CodeSpan(code_).subspan(first);
    const std::optional<Codes> product =
        without_sign(both.first(second - first), both.subspan(second - first));
    if (!product) return two(FormulaOp::multiply, place);
    code_.resize(first);
    stack_ -= 2;
    for (const Code& c : *product) emit(c, place);
  }
  void two(FormulaOp op, std::size_t place) {
    const std::size_t n = code_.size();
    if (n >= 2 && code_[n - 1].op == FormulaOp::constant &&
        code_[n - 2].op == FormulaOp::constant) {
      const double a = code_[n - 2].number;
      const double b = code_[n - 1].number;
      const double value =
          op == FormulaOp::power ? std::pow(a, b) : ops::apply_two<double>(op, a, b);
      code_[n - 2].number = checked(value, place);
      code_.pop_back();
      --stack_;
    } else {
      emit({op, 0}, place);
    }
  }
  double checked(double v, std::size_t place) const {
    if (!std::isfinite(static_cast<float>(v))) fail(place, "not a finite number");
    return v;
  }

  // Counts how deep the descent is, so that no text can exhaust the stack.
  struct Level {
    explicit Level(Parser& p) : parser(p) {
      if (++parser.depth_ > kDepth) parser.fail(parser.at_, "nested too deep");
    }
    ~Level() { --parser.depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    Parser& parser;
  };

  std::string_view text_;
  double t_;
  std::string_view variables_;
  std::size_t at_ = 0;
  int depth_ = 0;
  int stack_ = 0;
  Codes code_;
};

}  // namespace

std::vector<float> parse_formula(std::string_view text, double t, std::string_view variables) {
  std::vector<float> floats;
  for (const Code& code : Parser(text, t, variables).parse()) {
    floats.push_back(static_cast<float>(code.op));
    floats.push_back(static_cast<float>(code.number));
  }
  return floats;
}

double parse_number(std::string_view text, double t) {
  return Parser(text, t, "").parse()[0].number;
}

}  // namespace sdfgrid
