#include "io/pairs.hpp"

#include <algorithm>

#include "io/json.hpp"
#include "phasescan/io/error.hpp"
#include "io/number.hpp"

namespace phasescan {
namespace {

std::string text_of(const json::Json& object, const json::Place& place, const char* key, const std::string& absent) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return absent;
  if (found->is_string()) return found->get<std::string>();
  if (found->is_number_integer()) return found->dump();
  place.fail(key, std::string("\"") + key + "\" is a value of type " + found->type_name() + "; expected a string");
}

Scan part_of(const json::Json& object, const json::Place& place, const char* key) {
  const auto found = object.find(key);
  if (found == object.end()) {
    place.fail(
        "", std::string("\"") + key + "\" is missing; expected a pair {\"id\", \"reference\": SCAN, \"scan\": SCAN}");
  }
  try {
    return json::scan_from(*found, place);
  } catch (const InputError& error) {
    place.fail("", std::string(key) + ": " + error.reason());
  }
}

ScanPair parse_pair(const json::Place& place) {
  const json::Json object = json::parse(place);
  if (!object.is_object())
    place.fail("", "is no JSON object; expected a pair {\"id\", \"reference\": SCAN, \"scan\": SCAN}");
  ScanPair pair;
  pair.id = text_of(object, place, "id", std::to_string(place.line));
  pair.dataset = text_of(object, place, "dataset", "");
  pair.cls = text_of(object, place, "class", "");
  pair.reference = part_of(object, place, "reference");
  pair.scan = part_of(object, place, "scan");
  const auto truth = object.find("truth");
  if (truth != object.end() && !truth->is_null()) pair.truth = json::pose_from(*truth, place, "truth");
  if (const auto overlap = object.find("overlap"); overlap != object.end() && overlap->is_number()) {
    pair.overlap = overlap->get<double>();
  }
  if (const auto found = object.find("information"); found != object.end() && !found->is_null()) {
    const bool nine =
        found->is_array() && found->size() == 9 &&
        std::all_of(found->begin(), found->end(), [](const json::Json& entry) { return entry.is_number(); });
    if (!nine) place.fail("information", "\"information\" is something else; expected 9 numbers, row-major");
    Eigen::Matrix3d matrix;
    for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = (*found)[static_cast<std::size_t>(i)].get<double>();
    pair.information = matrix;
  }
  return pair;
}

}  // namespace

PairReader::PairReader(const std::string& path) : lines_(path) {}

std::optional<PairLine> PairReader::next() {
  if (ended_) return std::nullopt;
  PairLine out;
  try {
    do {
      if (!lines_.next(text_)) {
        ended_ = true;
        if (!any_) throw InputError(path(), 0, "holds no pair; expected JSON Lines, a pair a line");
        return std::nullopt;
      }
    } while (text_.find_first_not_of(" \t") == std::string::npos);
  } catch (const InputError& error) {
    if (!any_) throw;
    ended_ = true;
    out.line = error.line();
    out.error = error.reason();
    return out;
  }
  any_ = true;
  out.line = lines_.line_number();
  try {
    out.pair = parse_pair({path(), out.line, text_});
  } catch (const InputError& error) {
    out.error = error.reason();
  }
  return out;
}

std::vector<ScanPair> read_pairs(const std::string& path) {
  PairReader reader(path);
  std::vector<ScanPair> pairs;
  while (auto line = reader.next()) {
    if (!line->pair) throw InputError(path, line->line, line->error);
    pairs.push_back(std::move(*line->pair));
  }
  return pairs;
}

std::string format_pair(const ScanPair& pair) {
  std::string out = "{\"id\": ";
  json::append_string(out, pair.id);
  out += ", \"dataset\": ";
  json::append_string(out, pair.dataset);
  out += ", \"class\": ";
  json::append_string(out, pair.cls);
  out += ", \"reference\": ";
  json::append_scan(out, pair.reference);
  out += ", \"scan\": ";
  json::append_scan(out, pair.scan);
  out += ", \"truth\": ";
  if (pair.truth) {
    json::append_pose(out, *pair.truth);
  } else {
    out += "null";
  }
  if (pair.overlap) {
    out += ", \"overlap\": ";
    append_number(out, *pair.overlap);
  }
  if (pair.information) {
    for (int i = 0; i < 9; ++i) {
      out += i == 0 ? ", \"information\": [" : ",";
      append_number(out, (*pair.information)(i / 3, i % 3));
    }
    out += ']';
  }
  return out + '}';
}

}  // namespace phasescan
