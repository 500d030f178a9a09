#pragma once

#include <string>

namespace softfinger::tests {

/// A page inside a frame (headless Chromium's window cannot be made as narrow as a phone). When it
/// has loaded, `reader` runs, the body of an async function of `page`, the framed document's
/// element; then all that the page states about itself is copied out for --dump-dom, with the
/// frame's width. With ?full in the address the frame is as high as the page instead, to look at.
std::string framed_page(const std::string& page, int width, int height, const std::string& reader);

void write_page(const std::string& path, const std::string& content);

}  // namespace softfinger::tests
