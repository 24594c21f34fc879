#include "in_the_way.hpp"

#include <filesystem>
#include <stdexcept>
#include <system_error>

#include "io/file.hpp"

namespace phasescan::app {

void refuse_in_the_way(const std::string& flag, const std::string& file, const std::vector<std::string>& logs,
                       const std::string& out) {
  namespace fs = std::filesystem;
  if (file.empty()) return;
  std::error_code ignored;
  for (const std::string& log : logs) {
    if (fs::equivalent(file, log, ignored))
      throw std::invalid_argument(flag + ": " + quote_text(file) + " is the log itself; expected another file");
  }
  const fs::path path(file);
  const fs::path folder = fs::weakly_canonical(path.has_parent_path() ? path.parent_path() : ".", ignored);
  if (folder != fs::weakly_canonical(out, ignored)) return;
  for (const char* name : {"trajectory.tum", "scans.jsonl", "graph.g2o", "map.pgm", "map.yaml", "map.png",
                           "report.html", "timing.json", "summary.json"}) {
    if (path.filename() == name)
      throw std::invalid_argument(flag + ": " + quote_text(file) + " is a file of --out; expected another name");
  }
}

}  // namespace phasescan::app
