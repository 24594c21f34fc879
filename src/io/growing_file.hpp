/// A file that others may read while it is being written, and that a kill leaves as far as it was written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace phasescan {

/// Bytes are in the system's hands when `write` returns: a kill takes none of them back, a power cut those that the
/// system has not put on the disk yet. Never writes over a file that holds anything.
class GrowingFile {
 public:
  /// Makes the file, or takes an empty one. @throws InputError where its folder does not exist or it is no regular
  /// file, SystemError where the folder takes no file or there is something in it
  explicit GrowingFile(const std::string& path);
  ~GrowingFile();
  GrowingFile(GrowingFile&& other) noexcept;
  GrowingFile& operator=(GrowingFile&&) = delete;

  /// All of the bytes or none: where the disk is full, what it took of them is cut off again. @throws SystemError
  void write(std::string_view bytes);
  /// Brings all to the disk; nothing may be written afterwards. @throws SystemError
  void close();

  const std::string& path() const { return path_; }

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

/// The name itself where there is no such file yet or an empty one, else NAME-2.EXT, NAME-3.EXT, ...: the first that is
/// free.
std::string free_name(const std::string& path);

}  // namespace phasescan
