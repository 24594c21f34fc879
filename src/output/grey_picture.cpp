#include "output/grey_picture.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cctype>
#include <span>

#include "io/file.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan {
namespace {

constexpr std::size_t kHeaderBytes = 4096;

[[noreturn]] void refuse_size(const std::string& name, unsigned long width, unsigned long height) {
  throw InputError(
      name, 0, fmt::format("a picture of {} x {} pixels; expected 1 x 1 to {} in all", width, height, kMostMapPixels));
}

void check_size(unsigned long width, unsigned long height, const std::string& name) {
  if (width < 1 || height < 1 || width > kMostMapPixels || height > kMostMapPixels || width * height > kMostMapPixels)
    refuse_size(name, width, height);
}

/// The next number of a pgm header or a P2 body; comments run from # to the end of the line.
unsigned long pgm_number(std::string_view data, std::size_t& at, const std::string& name) {
  while (at < data.size()) {
    if (data[at] == '#') {
      while (at < data.size() && data[at] != '\n') ++at;
    } else if (std::isspace(static_cast<unsigned char>(data[at]))) {
      ++at;
    } else {
      break;
    }
  }
  unsigned long value = 0;
  std::size_t digits = 0;
  for (; at < data.size() && data[at] >= '0' && data[at] <= '9' && digits < 9; ++at, ++digits)
    value = 10 * value + static_cast<unsigned long>(data[at] - '0');
  if (digits == 0) throw InputError(name, 0, "the pgm image ends too early or holds something that is no number");
  return value;
}

bool is_pgm(std::string_view data) {
  return data.size() > 2 && data[0] == 'P' && (data[1] == '5' || data[1] == '2');
}
bool is_png(std::string_view data) {
  return data.size() > 8 && data.compare(1, 3, "PNG") == 0;
}

struct PgmHeader {
  bool binary = false;
  unsigned long width = 0, height = 0, most = 0;
  std::size_t end = 0;
};

PgmHeader pgm_header(std::string_view data, const std::string& name) {
  PgmHeader header;
  header.binary = data[1] == '5';
  header.end = 2;
  header.width = pgm_number(data, header.end, name);
  header.height = pgm_number(data, header.end, name);
  check_size(header.width, header.height, name);
  header.most = pgm_number(data, header.end, name);
  if (header.most < 1 || header.most > 255)
    throw InputError(name, 0, fmt::format("a pgm with {} grey levels; expected up to 255", header.most));
  return header;
}

GreyPicture decode_pgm(const std::string& data, const std::string& name) {
  const PgmHeader header = pgm_header(data, name);
  const std::size_t count = header.width * header.height;
  std::size_t at = header.end;
  const std::size_t left = data.size() - std::min(data.size(), at + 1);
  // A pixel in text takes a digit and, but for the last, a space.
  if (header.binary ? left < count : left + 1 < 2 * count)
    throw InputError(name, 0, fmt::format("the pgm has fewer than its {} x {} pixels", header.width, header.height));
  GreyPicture p{static_cast<int>(header.width), static_cast<int>(header.height), {}, {}};
  p.grey.resize(count);
  ++at;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned long value = header.binary ? static_cast<unsigned char>(data[at + i]) : pgm_number(data, at, name);
    p.grey[i] = static_cast<std::uint8_t>(std::min(255UL, value * 255 / header.most));
  }
  return p;
}

GreyPicture decode_png(const std::string& data, const std::string& name) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto fail = [&]() -> void {
    const std::string what = image.message;
    png_image_free(&image);
    throw InputError(name, 0, "not a readable PNG: " + what);
  };
  if (!png_image_begin_read_from_memory(&image, data.data(), data.size())) fail();
  if (image.width < 1 || image.height < 1 || static_cast<std::size_t>(image.width) * image.height > kMostMapPixels) {
    const unsigned long width = image.width, height = image.height;
    png_image_free(&image);
    refuse_size(name, width, height);
  }
  const bool transparent = (image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
  image.format = transparent ? PNG_FORMAT_GA : PNG_FORMAT_GRAY;
  std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
  GreyPicture p{static_cast<int>(image.width), static_cast<int>(image.height), {}, {}};
  if (!png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr)) fail();
  if (!transparent) {
    p.grey = std::move(pixels);
    return p;
  }
  for (std::size_t i = 0; i < pixels.size(); i += 2) {
    p.grey.push_back(pixels[i]);
    p.alpha.push_back(pixels[i + 1]);
  }
  return p;
}

}  // namespace

GreyPicture decode_grey_picture(const std::string& bytes, const std::string& name) {
  if (is_pgm(bytes)) return decode_pgm(bytes, name);
  if (is_png(bytes)) return decode_png(bytes, name);
  throw InputError(name, 0, "neither pgm (P5, P2) nor PNG");
}

GreyPicture read_grey_picture(const std::string& path) {
  InputStream stream(path);
  std::string bytes(kHeaderBytes, '\0');
  bytes.resize(stream.read(std::span<char>(bytes.data(), bytes.size())));
  if (!is_pgm(bytes) && !is_png(bytes)) throw InputError(path, 0, "neither pgm (P5, P2) nor PNG");
  if (is_pgm(bytes)) static_cast<void>(pgm_header(bytes, path));
  constexpr std::size_t kMostBytes = 5 * kMostMapPixels;  // a P2 of the largest size
  bytes += read_all(stream, kMostBytes);
  return decode_grey_picture(bytes, path);
}

}  // namespace phasescan
