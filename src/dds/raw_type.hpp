/// A type of CycloneDDS whose samples are bytes: CDR as it is on the wire, with its 4 bytes of encapsulation. No key.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

struct ddsi_sertype;

namespace phasescan::dds {

/// What is handed to dds_write: a pointer to one of these.
using RawSample = std::span<const std::uint8_t>;
/// What is handed to dds_take: a pointer to one of these.
using TakenSample = std::vector<std::uint8_t>;

/// A new type of that name, with one reference that dds_create_topic_sertype takes over.
ddsi_sertype* new_raw_type(const std::string& type_name);

}  // namespace phasescan::dds
