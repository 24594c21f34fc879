#include "options.hpp"

#include <limits>

namespace phasescan::python {
namespace {

[[noreturn]] void refuse(const char* expected, py::handle value) {
  throw std::invalid_argument("expected " + std::string(expected) + ", got " + std::string(py::repr(value)));
}

/// Section, option, value, default, unit, bounds and meaning of each.
template <class Root>
py::list describe(const Root& root) {
  py::list rows;
  const py::dict defaults = options_dict(Root{});
  Root::visit_sections(root, [&](std::string_view section_name, const auto& section) {
    const py::dict of_section = defaults[py::str(std::string(section_name))];
    std::decay_t<decltype(section)>::visit(section, [&](std::string_view name, const auto& value,
                                                        const OptionInfo& info) {
      const auto bound = [](double b) { return std::isfinite(b) ? py::object(py::float_(b)) : py::object(py::none()); };
      py::dict row;
      row["section"] = std::string(section_name);
      row["name"] = std::string(name);
      row["value"] = to_python(value);
      row["default"] = of_section[py::str(std::string(name))];
      row["unit"] = std::string(info.unit);
      row["min"] = bound(info.min);
      row["max"] = bound(info.max);
      row["meaning"] = std::string(info.meaning);
      rows.append(row);
    });
  });
  return rows;
}

/// Those options that are not the default: "MatchOptions(match={'fast': True})".
template <class Root>
std::string changed_text(const char* name, const Root& root) {
  const py::dict mine = options_dict(root), defaults = options_dict(Root{});
  std::string text;
  for (const auto& [section, values] : mine) {
    py::dict changed;
    const py::dict of_section = defaults[section];
    for (const auto& [option, value] : py::reinterpret_borrow<py::dict>(values)) {
      if (!value.equal(of_section[option])) changed[option] = value;
    }
    if (changed.empty()) continue;
    const std::string key = py::str(section);
    text += (text.empty() ? "" : ", ") + (key == "global" ? "global_" : key) + "=" + std::string(py::repr(changed));
  }
  return std::string(name) + "(" + text + ")";
}

template <class Root>
void bind_root(py::module_& module, const char* name, const char* about) {
  py::class_<Root> type(module, name, about);
  type.def(py::init([](const py::object& options, const py::kwargs& keywords) {
             return options_from<Root>(options, keywords);
           }),
           py::arg("options") = py::none());
  type.def("to_dict", &options_dict<Root>, "dict: Each section's options and their values.");
  type.def("describe", &describe<Root>,
           "list of dict: section, name, value, default, unit, min, max and meaning of each option.");
  type.def(
      "__getitem__",
      [](const Root& root, const std::string& section) -> py::object {
        const py::dict all = options_dict(root);
        if (!all.contains(section)) throw py::key_error(section);
        return all[py::str(section)];
      },
      py::arg("section"));
  type.def("__repr__", [name](const Root& root) { return changed_text(name, root); });
  type.def(
      "__eq__",
      [](const Root& root, const py::object& other) {
        return py::isinstance<Root>(other) && options_dict(root).equal(options_dict(other.cast<const Root&>()));
      },
      py::arg("other"));
  type.attr("__hash__") = py::none();
  type.def(py::pickle([](const Root& root) { return options_dict(root); },
                      [](const py::dict& state) { return options_from<Root>(state, py::kwargs()); }));
}

}  // namespace

void set_from_python(bool& out, py::handle value) {
  if (!py::isinstance<py::bool_>(value) && type_name(value) != "bool_") refuse("True or False", value);
  out = value.cast<bool>();
}

void set_from_python(int& out, py::handle value) {
  if (py::isinstance<py::bool_>(value)) refuse("a whole number", value);
  const py::object index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) {
    PyErr_Clear();
    refuse("a whole number", value);
  }
  const long long number = PyLong_AsLongLong(index.ptr());
  if (PyErr_Occurred() != nullptr || number < std::numeric_limits<int>::min() ||
      number > std::numeric_limits<int>::max()) {
    PyErr_Clear();
    refuse("a whole number of 32 bits", value);
  }
  out = static_cast<int>(number);
}

void set_from_python(double& out, py::handle value) {
  if (py::isinstance<py::bool_>(value) || py::isinstance<py::str>(value)) refuse("a number", value);
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() != nullptr) {
    PyErr_Clear();
    refuse("a number", value);
  }
  out = number;
}

void set_from_python(std::string& out, py::handle value) {
  if (!py::isinstance<py::str>(value)) refuse("a word", value);
  out = py::str(value);
}

void bind_options(py::module_& module) {
  constexpr const char* kHow =
      "\n\nParameters\n----------\noptions : dict or object of options, optional\n    What to begin with: defaults.\n"
      "**options\n    Options by name, or a section with a dict: ``global_={'candidates': 20}``. An unknown one names\n"
      "    the nearest; `describe` lists all.";
  bind_root<MatcherOptions>(module, "MatchOptions", (std::string("Options of matching, by section.") + kHow).c_str());
  bind_root<TrackingOptions>(module, "OdometryOptions", (std::string("Options of odometry.") + kHow).c_str());
  bind_root<MappingOptions>(module, "SlamOptions", (std::string("Options of SLAM, by section.") + kHow).c_str());
  bind_root<LocalizingOptions>(module, "LocalizeOptions",
                               (std::string("Options of localisation, by section.") + kHow).c_str());
}

}  // namespace phasescan::python
