#include "softfinger/input/errors.h"

#include <pybind11/pybind11.h>

namespace softfinger::python {
namespace {

namespace py = pybind11;

/// InputError becomes the one of the package. ConvergenceError becomes RuntimeError by itself.
void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    const py::object kind = py::module_::import("softfinger._errors").attr("InputError");
    const py::object raised =
        kind.attr("of_core")(error.where(), error.field(), error.value(), error.allowed());
    PyErr_SetObject(kind.ptr(), raised.ptr());
  }
}

}  // namespace

void bind_errors(py::module_& module) {
  py::register_exception_translator(&translate);
  module.attr("__version__") = SOFTFINGER_VERSION;
}

}  // namespace softfinger::python
