#include "words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "io/file.hpp"
#include "io/nearest_word.hpp"

namespace phasescan::app {
namespace {

constexpr const char* kWords = "words";

}  // namespace

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string list = "{" + fmt::format("{}", fmt::join(words, ",")) + "}";
  const auto check = [words = std::move(words), list](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return quote_text(text) + " is not in " + list + did_you_mean(text, std::span<const std::string>(words));
  };
  return {check, list, kWords};
}

CLI::Validator offers(std::vector<std::string> words) {
  // Not active: it refuses nothing and stays out of --help, where the description says it.
  return CLI::Validator([](std::string&) { return std::string(); },
                        "{" + fmt::format("{}", fmt::join(words, ",")) + "}", kWords)
      .active(false);
}

CLI::Validator offers(std::span<const std::string_view> words) {
  return offers(std::vector<std::string>(words.begin(), words.end()));
}

std::vector<std::string> words_of(CLI::Option& option) {
  std::vector<std::string> words;
  try {
    CLI::Validator validator = *option.get_validator(kWords);
    const std::string list = validator.active().get_description();
    std::istringstream stream(list.substr(1, list.size() - 2));
    for (std::string word; std::getline(stream, word, ',');) words.push_back(word);
  } catch (const CLI::OptionNotFound&) {
  }
  return words;
}

std::vector<std::string> flags_of(const CLI::App& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return flags;
}

std::vector<std::string> commands_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* sub : command.get_subcommands([](const CLI::App*) { return true; })) {
    if (!sub->get_group().empty()) names.push_back(sub->get_name());
  }
  return names;
}

}  // namespace phasescan::app
