// The library's failures as Python exceptions, with its words.
#include "bind.hpp"
#include "phasescan/io/error.hpp"
#include "phasescan/slam/state.hpp"

namespace phasescan::python {
namespace {

struct Classes {
  py::object input, system, option, state;
};
Classes* classes = nullptr;  // as long as the interpreter

py::object make_class(py::module_& module, const char* name, const py::tuple& bases, const char* about) {
  py::dict members;
  members["__doc__"] = about;
  members["__module__"] = "phasescan";
  py::object made = py::reinterpret_borrow<py::object>(reinterpret_cast<PyObject*>(&PyType_Type))(name, bases, members);
  module.attr(name) = made;
  return made;
}

py::object builtin(const char* name) {
  return py::module_::import("builtins").attr(name);
}

void raise_input_error(const InputError& error) {
  py::object made = classes->input(error.what());
  made.attr("file") = error.file();
  made.attr("line") = error.line();
  made.attr("reason") = error.reason();
  PyErr_SetObject(classes->input.ptr(), made.ptr());
}

void translate(std::exception_ptr failure) {
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const InputError& error) {
    raise_input_error(error);
  } catch (const SystemError& error) {
    PyErr_SetString(classes->system.ptr(), error.what());
  } catch (const StateError& error) {
    PyErr_SetString(classes->state.ptr(), error.what());
  } catch (const OptionError& error) {
    PyErr_SetString(classes->option.ptr(), error.what());
  } catch (const std::system_error& error) {
    PyErr_SetString(PyExc_OSError, error.what());
  }
}

}  // namespace

void bind_errors(py::module_& module) {
  const py::object value_error = builtin("ValueError");
  classes = new Classes;
  classes->input = make_class(module, "InputError", py::make_tuple(value_error),
                              "A file is not what it should be: ``FILE:LINE: what is wrong and what was expected``.\n\n"
                              "Attributes\n----------\nfile : str\nline : int\n    0 where the file has no lines.\n"
                              "reason : str\n    The message without the place.");
  classes->system = make_class(module, "SystemError", py::make_tuple(builtin("OSError")),
                               "The system said no: a permission, a full disk, a device that is gone.");
  classes->option = make_class(module, "OptionError", py::make_tuple(builtin("TypeError"), value_error),
                               "An option that does not exist; the message names the nearest one.");
  classes->state =
      make_class(module, "StateError", py::make_tuple(value_error), "Bytes that are no saved run, or a damaged one.");
  py::register_exception_translator(&translate);
}

std::string type_name(py::handle object) {
  return py::str(py::type::handle_of(object).attr("__name__"));
}

}  // namespace phasescan::python
