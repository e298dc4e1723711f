// SPDX-License-Identifier: Apache-2.0
/// Chromium without a window, for tests that look at pages as a reader's browser would.
#pragma once

#include <string>
#include <vector>

namespace quadtune::testing {

/// The program's path; empty where there is none.
[[nodiscard]] std::string find_browser();

struct BrowserResult {
  bool in_time = false;  ///< it ended by itself
  int status = -1;       ///< its exit status
  std::string out;       ///< its standard output, e.g. of --dump-dom
};

/// Opens a page and ends. Graphics are computed by the processor. No name of a host is resolved, so
/// that nothing leaves the machine, whatever a page or the browser itself may ask for.
///
/// @param file       the page's path
/// @param arguments  what to do with it, e.g. {"--dump-dom"}
[[nodiscard]] BrowserResult open_in_browser(const std::string& file,
                                            const std::vector<std::string>& arguments);

/// The HTML of the page after its scripts have run for some seconds.
[[nodiscard]] BrowserResult dump_page(const std::string& file,
                                      const std::vector<std::string>& arguments = {});

/// A picture of the page.
/// @param png  where it goes
[[nodiscard]] BrowserResult take_picture(const std::string& file, const std::string& png, int width,
                                         int height,
                                         const std::vector<std::string>& arguments = {});

}  // namespace quadtune::testing
