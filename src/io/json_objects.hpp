/// JSON objects of a text one by one, whatever stands between them: an array of scans, on one line or on many.
#pragma once

#include <string>

#include "io/file.hpp"

namespace phasescan {

class JsonObjects {
 public:
  explicit JsonObjects(InputStream stream) : stream_(std::move(stream)) {}

  /// The text of the next object that stands in no other, and the line it begins on. False at the end.
  /// @throws InputError where the text ends inside an object, where one is longer than any line may be, and where the
  /// packed data are broken; nothing more comes then
  bool next(std::string& text, long& line);

 private:
  bool refill();

  InputStream stream_;
  std::string buffer_;
  std::size_t at_ = 0;
  long line_ = 1;
  bool ended_ = false;
};

}  // namespace phasescan
