// SPDX-License-Identifier: Apache-2.0
/// Pages opened in a browser by tests, and what is read off them.
#pragma once

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "browser.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {

/// The value of a data attribute of the page's root element; "(none)" where it is absent.
[[nodiscard]] std::string root_data(const std::string& page, const std::string& name);

/// The page without its policy and with a script of the test, which runs once the page is drawn.
/// What the script puts into document.documentElement.dataset can be read with root_data().
[[nodiscard]] std::string with_script(const std::string& html, const std::string& script);

/// What web pages have asked for in a run with --log-net-log, by its log; what the browser itself
/// wants is left out.
[[nodiscard]] std::set<std::string> requests(const std::string& log);

/// A page that shows another one, of that name beside it, in a frame: a window cannot be as narrow
/// as a telephone. What the other posts goes into data-inside.
[[nodiscard]] std::string in_frame(const std::string& name, int width, int height);

/// Skips where there is no browser.
class Browser : public ::testing::Test {
 protected:
  void SetUp() override {
    if (find_browser().empty()) GTEST_SKIP() << "no chromium here, so no page is opened";
  }

  std::string write(const std::string& html, const std::string& name = "report.html") const {
    return place_.write(name, html).string();
  }

  /// The page after its scripts.
  std::string opened(const std::string& html,
                     const std::vector<std::string>& arguments = {}) const {
    const BrowserResult result = dump_page(write(html), arguments);
    EXPECT_TRUE(result.in_time) << "the browser did not end";
    EXPECT_EQ(result.status, 0);
    return result.out;
  }

  TemporaryDirectory place_;
};

}  // namespace quadtune::testing
