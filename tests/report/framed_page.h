#pragma once

#include <string>

namespace softfinger::tests {

/// A page inside a frame (headless Chromium's window cannot be made as narrow as a phone). When it
/// has loaded, the async function `read` of the script `reader` runs, a file of this folder, beside
/// page_checks.js; its argument is the framed document's element. Then all that the page states
/// about itself is copied out for --dump-dom, with the frame's width. With ?full in the address the
/// frame is as high as the page instead, to look at.
std::string framed_page(const std::string& page, int width, int height, const std::string& reader);

/// The page, as NAME.html, and in a frame as wide as a desk's screen and as narrow as a phone.
void write_framed(const std::string& folder, const std::string& name, const std::string& page,
                  const std::string& reader);

void write_page(const std::string& path, const std::string& content);

}  // namespace softfinger::tests
