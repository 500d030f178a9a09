#include "analytic/python/bindings/contacts.h"
#include "softfinger/accuracy/pressing_error.h"

namespace softfinger::python {
namespace {

/// Whether bounds are known, expected errors (6, n), their causes (4, 6, n), bounds (6, n), and why
/// nothing is known, per contact.
py::tuple bounds(const std::optional<std::string>& name, const py::dict& numbers) {
  const AskedModel model(name);
  const Contacts contacts(numbers);
  const std::size_t count = contacts.count();
  py::array_t<bool> known{py::ssize_t(count)};
  Numbers expected({kBoundedQuantities, count}), causes({kErrorCauses, kBoundedQuantities, count}),
      bound({kBoundedQuantities, count});
  std::vector<const char*> reasons(count);
  bool* is_known = known.mutable_data();
  double *expects = expected.mutable_data(), *cause = causes.mutable_data(),
         *within = bound.mutable_data();
  {
    const py::gil_scoped_release others_may_run;
    for (std::size_t i = 0; i < count; ++i) {
      const ContactProblem problem = contacts.problem(i);
      const ErrorBound found =
          error_bound(model.of(problem), problem, contacts.pressing_friction_coefficient(i));
      is_known[i] = found.known;
      reasons[i] = found.outside;
      for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
        expects[q * count + i] = found.expected[q];
        // Without a known bound the error is unbounded.
        within[q * count + i] = found.known ? found.bound[q] : kInfinity;
        for (std::size_t c = 0; c < kErrorCauses; ++c)
          cause[(c * kBoundedQuantities + q) * count + i] = found.causes[c][q];
      }
    }
  }
  py::list outside;
  for (const char* reason : reasons) outside.append(py::str(reason));
  return py::make_tuple(known, expected, causes, bound, outside);
}

}  // namespace

void bind_accuracy(py::module_& module) { module.def("error_bound", &bounds); }

}  // namespace softfinger::python
