#pragma once

#include <functional>
#include <memory>
#include <string>

namespace softfinger::fem {

/// Lines of progress from several threads, written in the order in which one thread would write
/// them: a line waits while an earlier part of the work may still write something. Copies share a
/// place.
class OrderedProgress {
 public:
  /// @param tell  is called by any thread, but never by two at a time
  OrderedProgress(std::function<void(const std::string&)> tell);

  void operator()(const std::string& line) const;

  /// A place for another thread's lines, after what this one has written so far. Later lines of
  /// this one wait until that place is closed, or it and its copies are gone.
  OrderedProgress place() const;
  /// Ends the place: no more lines follow here.
  void close() const;

 private:
  class Lines;
  class Place;
  explicit OrderedProgress(std::shared_ptr<Place> place);

  std::shared_ptr<Place> place_;
};

}  // namespace softfinger::fem
