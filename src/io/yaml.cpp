#include "io/yaml.hpp"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <sstream>
#include <vector>

#include "phasescan/io/error.hpp"
#include "io/file.hpp"

namespace phasescan {
namespace {

/// Counts what the parser meets and builds nothing.
class BoundsCheck : public YAML::EventHandler {
 public:
  BoundsCheck(const std::string& name, const YamlBounds& bounds) : name_(name), bounds_(bounds) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (started_) throw InputError(name_, mark.line + 1, "text after the end of the YAML document; expected one");
    started_ = true;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    count(mark);
    if (std::find(open_.begin(), open_.end(), anchor) != open_.end())
      throw InputError(name_, mark.line + 1, "a list or map that contains itself; expected plain values");
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string&) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    descend(mark, anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    descend(mark, anchor);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  void count(const YAML::Mark& mark) {
    if (++values_ > bounds_.values) {
      throw InputError(name_, mark.line + 1,
                       "more than " + std::to_string(bounds_.values) + " values; expected a smaller YAML file");
    }
  }
  void descend(const YAML::Mark& mark, YAML::anchor_t anchor) {
    count(mark);
    // An anchor of 0 is none, and no alias names it.
    open_.push_back(anchor);
    if (open_.size() > bounds_.depth) {
      throw InputError(name_, mark.line + 1,
                       "lists and maps more than " + std::to_string(bounds_.depth) + " deep; expected a flatter file");
    }
  }

  const std::string& name_;
  YamlBounds bounds_;
  bool started_ = false;
  std::size_t values_ = 0;
  std::vector<YAML::anchor_t> open_;  ///< of the lists and maps around the place
};

}  // namespace

YAML::Node parse_yaml(const std::string& text, const std::string& name, const YamlBounds& bounds) {
  if (text.size() > bounds.bytes) {
    throw InputError(name, 0, "larger than " + std::to_string(bounds.bytes >> 10) + " KiB; expected a YAML file");
  }
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    BoundsCheck check(name, bounds);
    // A second document, or one that is made of nothing, throws.
    while (parser.HandleNextDocument(check)) {
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(name, error.mark.is_null() ? 1 : error.mark.line + 1, "is not YAML: " + error.msg);
  }
}

YAML::Node read_yaml(const std::string& path, const YamlBounds& bounds) {
  return parse_yaml(read_file(path, bounds.bytes), path, bounds);
}

}  // namespace phasescan
