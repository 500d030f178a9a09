#include "fem/base/ordered_progress.h"

#include <list>
#include <mutex>
#include <utility>
#include <vector>

namespace softfinger::fem {

class OrderedProgress::Lines {
 public:
  struct Part {
    std::vector<std::string> waiting;
    bool is_open = true;
  };
  using Position = std::list<Part>::iterator;

  explicit Lines(std::function<void(const std::string&)> tell) : tell_(std::move(tell)) {}

  Position first() { return parts_.begin(); }

  void add(const Position& part, const std::string& line) {
    const std::lock_guard lock(mutex_);
    part->waiting.push_back(line);
    tell_due();
  }

  void close(const Position& part) {
    const std::lock_guard lock(mutex_);
    part->is_open = false;
    tell_due();
  }

  /// @returns the new part in the middle; the part that was given goes on after it
  Position split(Position& part) {
    const std::lock_guard lock(mutex_);
    const Position middle = parts_.emplace(std::next(part));
    const Position rest = parts_.emplace(std::next(middle));
    part->is_open = false;
    part = rest;
    tell_due();
    return middle;
  }

 private:
  void tell_due() {
    while (!parts_.empty()) {
      for (const std::string& line : std::exchange(parts_.front().waiting, {})) tell_(line);
      if (parts_.front().is_open) return;
      parts_.pop_front();
    }
  }

  std::function<void(const std::string&)> tell_;
  std::mutex mutex_;
  std::list<Part> parts_{1};
};

class OrderedProgress::Place {
 public:
  Place(std::shared_ptr<Lines> lines, Lines::Position part)
      : lines_(std::move(lines)), part_(part) {}
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  ~Place() { close(); }

  void close() {
    if (!std::exchange(is_closed_, true)) lines_->close(part_);
  }

  void add(const std::string& line) { lines_->add(part_, line); }
  std::shared_ptr<Place> split() { return std::make_shared<Place>(lines_, lines_->split(part_)); }

 private:
  std::shared_ptr<Lines> lines_;
  Lines::Position part_;
  bool is_closed_ = false;
};

OrderedProgress::OrderedProgress(std::function<void(const std::string&)> tell) {
  const auto lines = std::make_shared<Lines>(std::move(tell));
  place_ = std::make_shared<Place>(lines, lines->first());
}

OrderedProgress::OrderedProgress(std::shared_ptr<Place> place) : place_(std::move(place)) {}

void OrderedProgress::close() const { place_->close(); }

void OrderedProgress::operator()(const std::string& line) const { place_->add(line); }

OrderedProgress OrderedProgress::place() const { return OrderedProgress(place_->split()); }

}  // namespace softfinger::fem
