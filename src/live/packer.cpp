#include "live/packer.hpp"

#include <cmath>

#include "live/rplidar.hpp"

namespace phasescan::live {
namespace {

constexpr std::size_t kYdlidarSamples = 40;  // as the X4 sends them

ByteString bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

}  // namespace

void Packer::add(const WireSample& sample, double time_s, std::vector<WirePacket>& out) {
  if (model_.protocol == Protocol::kRplidar) return add_rplidar(sample, time_s, out);
  if (model_.protocol == Protocol::kYdlidar) return add_ydlidar(sample, time_s, out);
  if (held_.empty()) first_s_ = time_s;
  held_.push_back(sample);
  const double from = held_.front().turned_deg, to = held_.back().turned_deg, rpm = 60.0 * options_.turns_hz;
  const int degree = static_cast<int>(std::lround(from));
  const int in_delta = std::max(1, options_.samples_per_turn / 16);  // packets of 22.5 degrees
  const auto ms = static_cast<std::uint32_t>(std::fmod(1e3 * first_s_, 16777216.0));
  switch (model_.protocol) {
    case Protocol::kLd06:
      if (holds(12)) emit(ld06_packet(360.0 * options_.turns_hz, from, to, held_, ms), time_s, out);
      break;
    case Protocol::kXv11:
      if (holds(4)) emit(xv11_packet(degree / 4, rpm, held_), time_s, out);
      break;
    case Protocol::kLds01:
      if (holds(6)) emit(lds01_packet(degree / 6, rpm, held_), time_s, out);
      break;
    case Protocol::kCamsense:
      if (holds(8)) emit(camsense_packet(rpm, from, to, held_), time_s, out);
      break;
    case Protocol::kDelta2:
      if (holds(static_cast<std::size_t>(in_delta))) emit(delta2_packet(options_.turns_hz, from, held_), time_s, out);
      break;
    default:
      add_whole_turn(time_s, out);
  }
}

void Packer::add_whole_turn(double time_s, std::vector<WirePacket>& out) {
  if (!holds(static_cast<std::size_t>(options_.samples_per_turn))) return;
  if (model_.protocol == Protocol::kHokuyo) {
    const auto ms = static_cast<std::uint32_t>(std::fmod(1e3 * first_s_, 16777216.0));
    emit(bytes_of(scip_scan(options_.echo, "99", ms, held_)), time_s, out);
  } else {
    const auto us = static_cast<std::uint32_t>(std::fmod(1e6 * first_s_, 4294967296.0));
    emit(bytes_of(sick_scan("sSN", us, options_.turns_hz, options_.start_deg, options_.step_deg, held_)), time_s, out);
  }
}

void Packer::add_rplidar(const WireSample& sample, double time_s, std::vector<WirePacket>& out) {
  const int type = options_.rplidar_type;
  if (type == rplidar::kNodes) return emit(rplidar_node(sample), time_s, out);
  if (type == rplidar::kHqNodes) {
    held_.push_back(sample);
    if (holds(96)) emit(rplidar_hq(static_cast<std::uint64_t>(1e6 * time_s), held_), time_s, out);
    return;
  }
  // An ultra capsule needs the range behind it: all wait for one sample more.
  if (holds(rplidar::capsule_samples(type))) {
    const double start = held_.front().turned_deg;
    emit(rplidar_capsule(type, start, !began_, held_, sample.mm), last_s_, out);
    began_ = true;
  }
  held_.push_back(sample);
  last_s_ = time_s;
}

void Packer::add_ydlidar(const WireSample& sample, double time_s, std::vector<WirePacket>& out) {
  const auto packet = [&](bool starts, double at_s) {
    const double from = held_.front().turned_deg, to = held_.back().turned_deg;
    emit(ydlidar_packet(starts, options_.turns_hz, from, to, held_, options_.ydlidar_width, model_.mm_per_unit), at_s,
         out);
  };
  if (sample.starts_turn && !held_.empty()) packet(false, last_s_);
  held_.push_back(sample);
  last_s_ = time_s;
  if (sample.starts_turn || holds(kYdlidarSamples)) packet(sample.starts_turn, time_s);
}

}  // namespace phasescan::live
