#include "help.h"

#include <fmt/format.h>

#include <utility>

namespace sdfgrid::cli {
namespace {

constexpr std::size_t kColumn = 26;  // where the descriptions begin

// "FLOAT:POSITIVE" -> "X": what to type, without CLI11's words for how it is checked.
std::string placeholder(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::string word = type.substr(0, type.find(':'));
  if (word == "INT" || word == "UINT") return "N";
  if (word == "FLOAT") return "X";
  return word;
}

class HelpFormatter : public CLI::Formatter {
 public:
  explicit HelpFormatter(std::string usage) : usage_(std::move(usage)) { column_width(kColumn); }

  std::string make_usage(const CLI::App* /*app*/, std::string /*name*/) const override {
    return fmt::format("Usage: sdfgrid {}\n", usage_);
  }

  // Without the "{false}" that CLI11 adds to a flag that takes something away.
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    const std::string name = CLI::Formatter::make_option_name(option, is_positional);
    return name.substr(0, name.find('{'));
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    const bool takes_value = option->get_type_size() > 0 && option->get_expected_max() > 0;
    return takes_value && !option->get_positional() ? " " + placeholder(*option) : "";
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    const std::string value = option->get_default_str();
    return option->get_description() + (value.empty() ? "" : fmt::format(" [{}]", value));
  }

 private:
  std::string usage_;
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_format(const std::string& usage) {
  return std::make_shared<HelpFormatter>(usage);
}

}  // namespace sdfgrid::cli
