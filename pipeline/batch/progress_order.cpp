#include "batch/progress_order.h"

#include <cassert>
#include <utility>

namespace runcert {

std::string ReportOrder::say(std::size_t index, std::string_view text) {
    assert(index >= next_);
    if (index == next_) return std::string(text);
    held_[index].text += text;
    return {};
}

std::string ReportOrder::end(std::size_t index) {
    assert(index >= next_);
    held_[index].ended = true;
    std::string sayable;
    for (auto first = held_.find(next_); first != held_.end(); first = held_.find(next_)) {
        sayable += std::exchange(first->second.text, {});
        if (!first->second.ended) break;
        held_.erase(first);
        ++next_;
    }
    return sayable;
}

std::string ReportOrder::rest() {
    std::string all;
    for (auto& [index, held] : held_)
        all += std::exchange(held.text, {});
    return all;
}

}  // namespace runcert
