#include "ros2/codec.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <type_traits>

#include "io/cdr.hpp"

namespace phasescan::ros2 {
namespace {

constexpr Stamp kSecond = 1'000'000'000;

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

/// What a message is made of, written.
class Encoder {
 public:
  explicit Encoder(ByteWriter& out) : cdr_(out) {}

  void stamp(Stamp stamp) {
    const Stamp rest = (stamp % kSecond + kSecond) % kSecond;
    cdr_.put(static_cast<std::int32_t>((stamp - rest) / kSecond));
    cdr_.put(static_cast<std::uint32_t>(rest));
  }
  template <class T>
  void number(T value) {
    cdr_.put(value);
  }
  void text(const std::string& value) { cdr_.text(value); }
  void array(const Covariance6& value) { cdr_.array(std::span<const double>(value)); }
  template <class T>
  void numbers(const std::vector<T>& values) {
    cdr_.sequence(std::span<const T>(values));
  }
  template <class T, class Each>
  void elements(const std::vector<T>& values, Each each) {
    cdr_.put(static_cast<std::uint32_t>(values.size()));
    for (const T& value : values) each(value);
  }

 private:
  ros::CdrOutput cdr_;
};

/// The same, read.
class Decoder {
 public:
  explicit Decoder(Bytes bytes) : cdr_(bytes) {}

  void stamp(Stamp& stamp) {
    stamp = kSecond * cdr_.get<std::int32_t>();
    stamp += cdr_.get<std::uint32_t>();
  }
  template <class T>
  void number(T& value) {
    value = cdr_.get<T>();
  }
  void text(std::string& value) { value = cdr_.text(); }
  void array(Covariance6& value) {
    for (double& element : value) element = cdr_.get<double>();
  }
  template <class T>
  void numbers(std::vector<T>& values) {
    cdr_.sequence(values);
  }
  template <class T, class Each>
  void elements(std::vector<T>& values, Each each) {
    values.clear();
    // One by one: a count that the bytes do not hold ends at their end, not in memory that was asked for.
    for (auto n = cdr_.get<std::uint32_t>(); n > 0; --n) each(values.emplace_back());
  }

 private:
  ros::CdrInput cdr_;
};

/// Goes through the fields of a message, those of the messages in it too. @tparam Coder  Encoder or Decoder
template <class Coder>
class Fields {
 public:
  template <class Wire>
  explicit Fields(Wire&& wire) : coder_(wire) {}

  template <class T>
  void time(std::string_view, T&& stamp) {
    coder_.stamp(stamp);
  }
  template <class T>
  void operator()(std::string_view, T& value) {
    using Plain = std::remove_const_t<T>;
    if constexpr (std::is_arithmetic_v<Plain>) {
      coder_.number(value);
    } else if constexpr (std::is_same_v<Plain, std::string>) {
      coder_.text(value);
    } else if constexpr (std::is_same_v<Plain, Covariance6>) {
      coder_.array(value);
    } else if constexpr (!IsVector<Plain>::value) {
      Message<Plain>::visit(value, *this);
    } else if constexpr (std::is_arithmetic_v<typename Plain::value_type>) {
      coder_.numbers(value);
    } else {
      coder_.elements(value, [this](auto& element) { Message<typename Plain::value_type>::visit(element, *this); });
    }
  }

 private:
  Coder coder_;
};

template <class T>
constexpr std::string_view number_name(bool idl) {
  if constexpr (std::is_same_v<T, float>) return idl ? "float" : "float32";
  if constexpr (std::is_same_v<T, double>) return idl ? "double" : "float64";
  if constexpr (std::is_same_v<T, std::int8_t>) return idl ? "int8" : "int8";
  if constexpr (std::is_same_v<T, std::uint8_t>) return idl ? "octet" : "byte";
  if constexpr (std::is_same_v<T, std::uint32_t>) return idl ? "unsigned long" : "uint32";
  return "";
}

/// "sensor_msgs/msg/LaserScan" as "sensor_msgs/LaserScan".
std::string short_name(std::string_view type) {
  const std::size_t slash = type.find('/');
  return std::string(type.substr(0, slash)) + std::string(type.substr(type.rfind('/')));
}

struct TypeText {
  std::string type, fields;
};
using TypeTexts = std::vector<TypeText>;

/// Adds a type behind those that it is made of, once.
template <class T>
void describe(bool idl, TypeTexts& types);

class Describer {
 public:
  Describer(bool idl, TypeTexts& types) : idl_(idl), types_(types) {}

  void time(std::string_view name, Stamp) {
    const std::string type = "builtin_interfaces/msg/Time";
    if (!known(type)) {
      types_.push_back({type, idl_ ? "long sec_;\nunsigned long nanosec_;\n" : "int32 sec\nuint32 nanosec\n"});
    }
    field(named(type), "", name);
  }
  template <class T>
  void operator()(std::string_view name, const T&) {
    if constexpr (std::is_same_v<T, Covariance6>) {
      field("double", "36", name);
    } else if constexpr (IsVector<T>::value) {
      field(name_of<typename T::value_type>(), "*", name);
    } else {
      field(name_of<T>(), "", name);
    }
  }
  bool known(std::string_view type) const {
    return std::any_of(types_.begin(), types_.end(), [&](const TypeText& known) { return known.type == type; });
  }
  std::string fields;

 private:
  template <class T>
  std::string name_of() {
    if constexpr (std::is_arithmetic_v<T>) return std::string(number_name<T>(idl_));
    if constexpr (std::is_same_v<T, std::string>) return "string";
    if constexpr (!std::is_arithmetic_v<T> && !std::is_same_v<T, std::string>) {
      describe<T>(idl_, types_);
      return named(Message<T>::type);
    }
  }
  std::string named(std::string_view type) const {
    if (!idl_) return short_name(type);
    const std::string plain = short_name(type);
    const std::size_t slash = plain.find('/');
    return plain.substr(0, slash) + "::msg::dds_::" + plain.substr(slash + 1) + "_";
  }
  /// @param count  "" one, "*" a sequence, "36" an array
  void field(std::string type, const std::string& count, std::string_view name) {
    if (!idl_ && type == "double") type = "float64";
    if (idl_) {
      const std::string whole = count == "*" ? "sequence<" + type + ">" : type;
      fields += whole + " " + std::string(name) + "_" + (count == "36" ? "[36]" : "") + ";\n";
    } else {
      fields += type + (count == "*" ? "[]" : count.empty() ? "" : "[" + count + "]") + " " + std::string(name) + "\n";
    }
  }
  bool idl_;
  TypeTexts& types_;
};

template <class T>
void describe(bool idl, TypeTexts& types) {
  Describer describer(idl, types);
  if (describer.known(Message<T>::type)) return;
  const T empty{};
  Message<T>::visit(empty, describer);
  types.push_back({std::string(Message<T>::type), describer.fields});
}

}  // namespace

template <class M>
std::vector<std::uint8_t> encode(const M& message) {
  ByteWriter out;
  Message<M>::visit(message, Fields<Encoder>(out));
  return out.bytes();
}

template <class M>
M decode(Bytes bytes) {
  M message;
  Message<M>::visit(message, Fields<Decoder>(bytes));
  return message;
}

template <class M>
std::string definition() {
  TypeTexts types;
  describe<M>(false, types);
  std::string out = types.back().fields;
  for (std::size_t i = 0; i + 1 < types.size(); ++i) {
    out += std::string(80, '=') + "\nMSG: " + short_name(types[i].type) + "\n" + types[i].fields;
  }
  return out;
}

std::string idl() {
  TypeTexts types;
  for_each_topic_type([&]<class M>() { describe<M>(true, types); });
  std::string out;
  for (const TypeText& type : types) {
    const std::string plain = short_name(type.type);
    const std::size_t slash = plain.find('/');
    out += "module " + plain.substr(0, slash) + " { module msg { module dds_ {\n@final @topic\nstruct " +
           plain.substr(slash + 1) + "_ {\n" + type.fields + "};\n}; }; };\n";
  }
  return out;
}

#define PHASESCAN_ROS2_MESSAGE(M)                         \
  template std::vector<std::uint8_t> encode<M>(const M&); \
  template M decode<M>(Bytes);                            \
  template std::string definition<M>();
PHASESCAN_ROS2_MESSAGE(LaserScan)
PHASESCAN_ROS2_MESSAGE(TFMessage)
PHASESCAN_ROS2_MESSAGE(Odometry)
PHASESCAN_ROS2_MESSAGE(PoseStamped)
PHASESCAN_ROS2_MESSAGE(PoseWithCovarianceStamped)
PHASESCAN_ROS2_MESSAGE(Path)
PHASESCAN_ROS2_MESSAGE(MapMetaData)
PHASESCAN_ROS2_MESSAGE(OccupancyGrid)
PHASESCAN_ROS2_MESSAGE(DiagnosticArray)
PHASESCAN_ROS2_MESSAGE(ParticleCloud)
PHASESCAN_ROS2_MESSAGE(String)
#undef PHASESCAN_ROS2_MESSAGE

}  // namespace phasescan::ros2
