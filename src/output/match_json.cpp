#include "output/match_json.hpp"

#include <cmath>

#include "io/json.hpp"
#include "io/number.hpp"

namespace phasescan {
namespace {

void append_finite(std::string& out, double value) {
  if (std::isfinite(value)) {
    append_number(out, value);
  } else {
    out += "null";
  }
}

void append_result_pose(std::string& out, const Pose2& pose) {
  out += "{\"x\": ";
  append_finite(out, pose.x);
  out += ", \"y\": ";
  append_finite(out, pose.y);
  out += ", \"theta\": ";
  append_finite(out, pose.theta);
  out += '}';
}

void append_times(std::string& out, const MatchTimes& ms) {
  const std::pair<const char*, double> parts[] = {{"total", ms.total},
                                                  {"image", ms.image},
                                                  {"missing", ms.missing},
                                                  {"rotation", ms.rotation},
                                                  {"translation", ms.translation},
                                                  {"refine", ms.refine}};
  out += ", \"ms\": {";
  for (const auto& [name, value] : parts) {
    out.append(out.ends_with('{') ? "\"" : ", \"").append(name).append("\": ");
    append_finite(out, std::round(value * 1e4) / 1e4);
  }
  out += '}';
}

}  // namespace

std::string format_match(std::string_view id, MatchMethod method, const MatchResult& result, bool times) {
  const auto truth = [](bool value) { return value ? "true" : "false"; };
  std::string out = "{\"id\": ";
  json::append_string(out, id);
  out.append(", \"method\": \"").append(to_string(method)).append("\", \"usable\": ").append(truth(result.usable));
  out.append(", \"reason\": \"").append(to_string(result.status)).append("\", \"pose\": ");
  append_result_pose(out, result.T_ref_scan);
  for (int i = 0; i < 9; ++i) {
    out += i == 0 ? ", \"covariance\": [" : ", ";
    append_finite(out, result.covariance(i / 3, i % 3));
  }
  out += "], \"confidence\": ";
  append_finite(out, result.confidence.value_or(std::nan("")));
  out += ", \"overlap\": ";
  append_finite(out, result.overlap);
  out.append(", \"ambiguous\": ").append(truth(result.ambiguous)).append(", \"alternatives\": [");
  for (const MatchAlternative& other : result.alternatives) {
    out += out.ends_with('[') ? "{\"pose\": " : ", {\"pose\": ";
    append_result_pose(out, other.T_ref_scan);
    out += ", \"confidence\": ";
    append_finite(out, other.confidence);
    out += '}';
  }
  out.append("], \"rotation_source\": \"").append(to_string(result.diagnostics.rotation_source)).append("\"");
  if (times) append_times(out, result.diagnostics.ms);
  return out + '}';
}

std::string format_pair_error(long line, std::string_view reason) {
  std::string out = "{\"line\": " + std::to_string(line) + ", \"error\": ";
  json::append_string(out, reason);
  return out + '}';
}

}  // namespace phasescan
