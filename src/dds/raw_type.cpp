#include "dds/raw_type.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <new>

namespace phasescan::dds {
namespace {

// CycloneDDS works with structs of C whose first member it knows and with tables of functions. No exception may leave
// these functions: where there is no memory they give null, which it takes for a lost sample.

struct RawData : ddsi_serdata {
  std::vector<std::uint8_t> bytes;  // filled up with zeros to a multiple of 4, as it is sent
};

RawData* new_data(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) noexcept {
  try {
    auto* data = new RawData;
    ddsi_serdata_init(data, type, kind);
    data->bytes.resize((size + 3) / 4 * 4);
    return data;
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

const RawData& of(const ddsi_serdata* data) {
  return *static_cast<const RawData*>(data);
}

bool same_key(const ddsi_serdata*, const ddsi_serdata*) {
  return true;
}
std::uint32_t size_of(const ddsi_serdata* data) {
  return static_cast<std::uint32_t>(of(data).bytes.size());
}

/// Fragments as they came over the network; they may overlap.
ddsi_serdata* from_fragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* fragment,
                             std::size_t size) {
  RawData* data = new_data(type, kind, size);
  std::uint32_t done = 0;
  for (; data != nullptr && fragment != nullptr; fragment = fragment->nextfrag) {
    const std::uint32_t end = std::min(fragment->maxp1, static_cast<std::uint32_t>(size));
    if (end <= done || fragment->min > done) continue;
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(fragment->rmsg, NN_RDATA_PAYLOAD_OFF(fragment));
    std::memcpy(data->bytes.data() + done, payload + (done - fragment->min), end - done);
    done = end;
  }
  return data;
}

ddsi_serdata* from_pieces(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t count,
                          const ddsrt_iovec_t* pieces, std::size_t size) {
  RawData* data = new_data(type, kind, size);
  std::size_t done = 0;
  for (ddsrt_msg_iovlen_t i = 0; data != nullptr && i < count; ++i) {
    const std::size_t n = std::min<std::size_t>(pieces[i].iov_len, size - done);
    std::memcpy(data->bytes.data() + done, pieces[i].iov_base, n);
    done += n;
  }
  return data;
}

ddsi_serdata* from_keyhash(const ddsi_sertype* type, const ddsi_keyhash*) {
  return new_data(type, SDK_KEY, 0);
}

ddsi_serdata* from_sample(const ddsi_sertype* type, ddsi_serdata_kind kind, const void* sample) {
  const RawSample& bytes = *static_cast<const RawSample*>(sample);
  RawData* data = new_data(type, kind, kind == SDK_DATA ? bytes.size() : 0);
  if (data != nullptr && kind == SDK_DATA) std::copy(bytes.begin(), bytes.end(), data->bytes.begin());
  return data;
}

void to_buffer(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* buffer) {
  std::memcpy(buffer, of(data).bytes.data() + offset, size);
}

ddsi_serdata* to_reference(const ddsi_serdata* data, std::size_t offset, std::size_t size, ddsrt_iovec_t* reference) {
  reference->iov_base = const_cast<std::uint8_t*>(of(data).bytes.data()) + offset;
  reference->iov_len = static_cast<ddsrt_iov_len_t>(size);
  return ddsi_serdata_ref(data);
}
void drop_reference(ddsi_serdata* data, const ddsrt_iovec_t*) {
  ddsi_serdata_unref(data);
}

bool to_sample(const ddsi_serdata* data, void* sample, void** pool, void*) {
  if (pool != nullptr) return false;
  try {
    *static_cast<TakenSample*>(sample) = of(data).bytes;
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

ddsi_serdata* to_untyped(const ddsi_serdata* data) {
  RawData* out = new_data(data->type, SDK_KEY, 0);
  if (out != nullptr) out->type = nullptr;
  return out;
}
bool untyped_to_sample(const ddsi_sertype*, const ddsi_serdata*, void* sample, void**, void*) {
  static_cast<TakenSample*>(sample)->clear();
  return true;
}
void free_data(ddsi_serdata* data) {
  delete static_cast<RawData*>(data);
}
std::size_t print(const ddsi_sertype*, const ddsi_serdata* data, char* buffer, std::size_t size) {
  return static_cast<std::size_t>(std::snprintf(buffer, size, "%zu bytes", of(data).bytes.size()));
}
void get_keyhash(const ddsi_serdata*, ddsi_keyhash* hash, bool) {
  std::memset(hash, 0, sizeof(*hash));
}

const ddsi_serdata_ops kDataOps = [] {
  ddsi_serdata_ops ops{};
  ops.eqkey = same_key;
  ops.get_size = size_of;
  ops.from_ser = from_fragments;
  ops.from_ser_iov = from_pieces;
  ops.from_keyhash = from_keyhash;
  ops.from_sample = from_sample;
  ops.to_ser = to_buffer;
  ops.to_ser_ref = to_reference;
  ops.to_ser_unref = drop_reference;
  ops.to_sample = to_sample;
  ops.to_untyped = to_untyped;
  ops.untyped_to_sample = untyped_to_sample;
  ops.free = free_data;
  ops.print = print;
  ops.get_keyhash = get_keyhash;
  return ops;
}();

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
// Samples are always the caller's: nothing is lent.
void zero_samples(const ddsi_sertype*, void*, std::size_t) {}
void realloc_samples(void** samples, const ddsi_sertype*, void*, std::size_t, std::size_t count) {
  std::fill(samples, samples + count, nullptr);
}
void free_samples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
bool same_type(const ddsi_sertype*, const ddsi_sertype*) {
  return true;  // the names were compared
}
std::uint32_t hash_of(const ddsi_sertype*) {
  return 0;
}

const ddsi_sertype_ops kTypeOps = [] {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = free_type;
  ops.zero_samples = zero_samples;
  ops.realloc_samples = realloc_samples;
  ops.free_samples = free_samples;
  ops.equal = same_type;
  ops.hash = hash_of;
  return ops;
}();

}  // namespace

ddsi_sertype* new_raw_type(const std::string& type_name) {
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init(type, type_name.c_str(), &kTypeOps, &kDataOps, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

}  // namespace phasescan::dds
