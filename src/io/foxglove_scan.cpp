// Sources: foxglove/foxglove-sdk, schemas LaserScan.json and LaserScan.proto; protobuf.dev, "Encoding".
#include "io/foxglove_scan.hpp"

#include <cmath>
#include <limits>

#include "io/json.hpp"
#include "phasescan/io/scan_json.hpp"
#include "phasescan/io/error.hpp"

namespace phasescan::ros {
namespace {

constexpr Stamp kSecond = 1'000'000'000;

Stamp stamp_of(double seconds, double nanoseconds) {
  if (!(std::abs(seconds) < kMostStampSeconds) || !(nanoseconds >= 0.0 && nanoseconds < 1e9))
    throw DecodeError("a time that is none");
  return static_cast<Stamp>(seconds) * kSecond + static_cast<Stamp>(nanoseconds);
}

// --- JSON ------------------------------------------------------------------------------------------------------------

double number_of(const json::Json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) throw DecodeError(std::string("no number '") + key + "'");
  return found->get<double>();
}

void read_numbers(const json::Json& object, const char* key, std::vector<float>& out) {
  out.clear();
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return;
  if (!found->is_array() || found->size() > kMaxBeams) throw DecodeError(std::string("no array '") + key + "'");
  for (const json::Json& value : *found) {
    if (!value.is_number() && !value.is_null() && !value.is_string())
      throw DecodeError(std::string("no numbers in '") + key + "'");
    // A word is what is no finite number; which one it was does not matter for a beam without a return.
    out.push_back(value.is_number() ? json::bounded(value.get<double>()) : std::numeric_limits<float>::quiet_NaN());
  }
}

void read_json(Bytes data, LaserScan& out) {
  const std::string_view text(reinterpret_cast<const char*>(data.data()), data.size());
  json::Json object;
  try {
    const std::string nameless;
    object = json::parse({nameless, 1, text});
  } catch (const InputError& error) {
    throw DecodeError(error.reason());
  }
  if (!object.is_object()) throw DecodeError("no JSON object");
  const auto time = object.find("timestamp");
  out.header.stamp = 0;
  if (time != object.end() && time->is_object())
    out.header.stamp = stamp_of(number_of(*time, "sec"), number_of(*time, "nsec"));
  const auto frame = object.find("frame_id");
  out.header.frame_id = frame != object.end() && frame->is_string() ? frame->get<std::string>() : std::string();
  out.angle_min = static_cast<float>(number_of(object, "start_angle"));
  out.angle_max = static_cast<float>(number_of(object, "end_angle"));
  read_numbers(object, "ranges", out.ranges);
  read_numbers(object, "intensities", out.intensities);
}

// --- protobuf --------------------------------------------------------------------------------------------------------

/// A message's fields one by one.
class Fields {
 public:
  explicit Fields(Bytes message) : reader_(message) {}

  struct Field {
    std::uint64_t number = 0, wire_type = 0;
    std::uint64_t value = 0;  ///< of a varint, or the bits of a fixed one
    Bytes bytes;              ///< of a string, a message or a packed array
  };

  bool next(Field& field) {
    if (reader_.remaining() == 0) return false;
    const std::uint64_t tag = varint();
    field = {tag >> 3U, tag & 7U, 0, {}};
    switch (field.wire_type) {
      case 0:
        field.value = varint();
        return true;
      case 1:
        field.value = reader_.get<std::uint64_t>();
        return true;
      case 2:
        field.bytes = reader_.bytes(varint());
        return true;
      case 5:
        field.value = reader_.get<std::uint32_t>();
        return true;
      default:
        throw DecodeError("no protobuf: wire type " + std::to_string(field.wire_type));
    }
  }

 private:
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const auto byte = reader_.get<std::uint8_t>();
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    throw DecodeError("no protobuf: a varint without end");
  }

  ByteReader reader_;
};

float as_float(std::uint64_t bits) {
  return json::bounded(std::bit_cast<double>(bits));
}

Stamp read_timestamp(Bytes message) {
  std::uint64_t seconds = 0, nanoseconds = 0;
  Fields fields(message);
  for (Fields::Field field; fields.next(field);) {
    if (field.wire_type != 0) continue;
    if (field.number == 1) seconds = field.value;
    if (field.number == 2) nanoseconds = field.value;
  }
  return stamp_of(static_cast<double>(static_cast<std::int64_t>(seconds)), static_cast<double>(nanoseconds));
}

/// A repeated double: packed, or one field each.
void add_doubles(const Fields::Field& field, std::vector<float>& out) {
  if (field.wire_type == 1) out.push_back(as_float(field.value));
  if (field.wire_type != 2) return;
  ByteReader packed(field.bytes);
  while (packed.remaining() > 0) out.push_back(as_float(packed.get<std::uint64_t>()));
}

void read_protobuf(Bytes data, LaserScan& out) {
  Fields fields(data);
  out.header = {};
  for (Fields::Field field; fields.next(field);) {
    const bool is_bytes = field.wire_type == 2;
    if (field.number == 1 && is_bytes) out.header.stamp = read_timestamp(field.bytes);
    if (field.number == 2 && is_bytes)
      out.header.frame_id.assign(reinterpret_cast<const char*>(field.bytes.data()), field.bytes.size());
    if (field.number == 4 && field.wire_type == 1) out.angle_min = as_float(field.value);
    if (field.number == 5 && field.wire_type == 1) out.angle_max = as_float(field.value);
    if (field.number == 6) add_doubles(field, out.ranges);
    if (field.number == 7) add_doubles(field, out.intensities);
    if (out.ranges.size() > kMaxBeams || out.intensities.size() > kMaxBeams)
      throw DecodeError("more beams than any scan has");
  }
}

}  // namespace

void decode_foxglove(Wire wire, Bytes data, LaserScan& out) {
  LaserScan made;
  made.ranges = std::move(out.ranges);
  made.intensities = std::move(out.intensities);
  made.ranges.clear();
  made.intensities.clear();
  if (wire == Wire::kJson) {
    read_json(data, made);
  } else {
    read_protobuf(data, made);
  }
  if (made.ranges.size() > 1)
    made.angle_increment = (made.angle_max - made.angle_min) / static_cast<float>(made.ranges.size() - 1);
  out = std::move(made);
}

}  // namespace phasescan::ros
