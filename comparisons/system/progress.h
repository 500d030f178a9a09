#pragma once

#include <string>

namespace softfinger::system {

/// Progress on standard error: one live line on a terminal, plain lines in a pipe; nothing where
/// the person asked for quiet.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// A line that stays.
  void say(const std::string& line);
  /// An error, which quiet does not hide: "softfinger: error: ...".
  void fail(const std::string& line);
  /// The present state, shown only on a terminal and cut to its width; the next line replaces it.
  void show(const std::string& line);

 private:
  void clear();
  bool terminal_;
  bool shown_ = false;
};

}  // namespace softfinger::system
