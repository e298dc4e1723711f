// SPDX-License-Identifier: Apache-2.0
/// Headless Chromium, for tests of pages as in a reader's browser.
#pragma once

#include <string>
#include <vector>

namespace quadtune::testing {

/// The path of the program; empty if it is not installed.
[[nodiscard]] std::string find_browser();

struct BrowserResult {
  bool in_time = false;  ///< it ended by itself
  int status = -1;       ///< its exit status
  std::string out;       ///< its standard output, e.g. of --dump-dom
};

/// Opens a page and ends. Graphics are rendered by the processor. Host names are not resolved, so
/// that nothing leaves the machine, whatever a page or the browser itself requests.
///
/// @param file       path of the page
/// @param arguments  the action, e.g. {"--dump-dom"}
[[nodiscard]] BrowserResult open_in_browser(const std::string& file,
                                            const std::vector<std::string>& arguments);

/// The HTML of the page after its scripts have run for some seconds.
[[nodiscard]] BrowserResult dump_page(const std::string& file,
                                      const std::vector<std::string>& arguments = {});

/// A picture of the page.
/// @param png  file to write
[[nodiscard]] BrowserResult take_picture(const std::string& file, const std::string& png, int width,
                                         int height,
                                         const std::vector<std::string>& arguments = {});

}  // namespace quadtune::testing
