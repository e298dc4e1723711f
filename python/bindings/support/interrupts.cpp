// SPDX-License-Identifier: Apache-2.0
#include "interrupts.hpp"

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <thread>

namespace quadtune::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kBetweenLooks{50};

}  // namespace

// The handlers run in the thread that called, because Python runs them in its main thread alone;
// the threads of a search or a campaign could not.
void run_interruptibly(const std::function<void(const Stop& stop)>& work) {
  std::atomic<bool> stopped{false};
  std::exception_ptr failure;
  std::optional<py::error_already_set> raised;
  {
    const py::gil_scoped_release without_gil;
    std::promise<void> ended;
    const std::future<void> end = ended.get_future();
    std::thread worker([&] {
      try {
        work([&stopped] { return stopped.load(); });
      } catch (...) {
        failure = std::current_exception();
      }
      ended.set_value();
    });
    while (end.wait_for(kBetweenLooks) != std::future_status::ready) {
      if (raised) continue;
      const py::gil_scoped_acquire gil;
      if (PyErr_CheckSignals() == 0) continue;
      raised.emplace();  // takes the exception from the interpreter
      stopped = true;
    }
    worker.join();
  }
  if (raised) throw py::error_already_set(*raised);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace quadtune::python
