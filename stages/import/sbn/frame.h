#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "core/failure.h"
#include "stages/import/recording.h"

namespace runcert::sbn {

/// A piece of a log: a message, or one that is none.
struct Frame {
    std::size_t offset = 0;          ///< of its first byte in the log
    std::string_view payload;        ///< its message number first; empty where it is none
    std::optional<Failure> failure;  ///< why it is none
};

/// Goes through a log frame by frame, and finds the next one after bytes that are none. Each such
/// stretch is given as one frame with a failure; bytes 0x00 or 0xFF at the end, room that was
/// never written, are passed over.
class FrameReader {
  public:
    explicit FrameReader(const RecordingBytes& recording) : recording_(recording) {}

    /// The next frame; nothing at the end.
    std::optional<Frame> next();

  private:
    Frame read_frame(std::size_t start);
    Frame bad(std::size_t start, std::string_view what) const;

    const RecordingBytes& recording_;
    std::size_t at_ = 0;
    bool in_bad_stretch_ = false;
};

}  // namespace runcert::sbn
