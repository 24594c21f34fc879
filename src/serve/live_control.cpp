#include "serve/live_control.hpp"

#include <algorithm>

namespace phasescan::serve {

bool check_save_name(const std::string& name, std::string& why) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  const bool fine =
      !name.empty() && name.size() <= 64 && letter(name.front()) &&
      std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || c == '-' || c == '_' || c == '.'; });
  if (!fine) why = "a name has 1 to 64 letters, digits, - _ . and begins with a letter or a digit";
  return fine;
}

}  // namespace phasescan::serve
