#pragma once

#include <fcntl.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <variant>
#include <vector>

namespace runcert::test {

/// What a terminal shows that is as high as needed, breaks lines that are too long and breaks them
/// anew when its width changes. It knows nothing but what progress may write, and throws at
/// anything else.
class Screen {
  public:
    explicit Screen(std::size_t width) : width_(width) {}

    void resize(std::size_t width) { width_ = width; }

    void take(const std::string& text) {
        for (std::size_t at = 0; at < text.size();) {
            const char c = text[at];
            if (c == '\x1b') {
                const std::size_t end = text.find_first_of("AJm", at);
                if (end == std::string::npos || text[at + 1] != '[')
                    throw std::runtime_error("unknown sequence");
                const std::string sequence = text.substr(at + 2, end - at - 1);
                if (sequence == "A")
                    up();
                else if (sequence == "J")
                    erase_below();
                else if (sequence.back() != 'm')
                    throw std::runtime_error("unknown sequence " + sequence);
                at = end + 1;
            } else if (c == '\r') {
                cell_ = row() * width_;
                is_behind_ = false;
                ++at;
            } else if (c == '\n') {
                down();
                ++at;
            } else {
                if (static_cast<unsigned char>(c) < ' ') throw std::runtime_error("control");
                std::size_t bytes = 1;
                while (at + bytes < text.size() && (text[at + bytes] & '\xc0') == '\x80')
                    ++bytes;
                put(text.substr(at, bytes));
                at += bytes;
            }
        }
    }

    /// Every row, without blanks at its end; rows below the last that is not empty are left out.
    std::vector<std::string> rows() const {
        std::vector<std::string> rows;
        for (const auto& line : lines_)
            for (std::size_t begin = 0; begin == 0 || begin < line.size(); begin += width_) {
                std::string row;
                for (std::size_t i = begin; i < std::min(line.size(), begin + width_); ++i)
                    row += line[i];
                rows.push_back(row.substr(0, row.find_last_not_of(' ') + 1));
            }
        while (!rows.empty() && rows.back().empty())
            rows.pop_back();
        return rows;
    }

    bool cursor_is_at_the_end() const {
        return line_ + 1 == lines_.size() && cell_ == lines_.back().size();
    }
    bool cursor_is_at_the_left() const { return cell_ == 0; }

  private:
    /// The row of the cursor in its line. Behind the last column, where it is after a character
    /// there, it is still on the row.
    std::size_t row() const {
        return is_behind_ && cell_ % width_ == 0 ? cell_ / width_ - 1 : cell_ / width_;
    }
    void up() {
        if (row() > 0) {
            cell_ -= width_;
        } else if (line_ > 0) {
            --line_;
            const std::size_t size = lines_[line_].size();
            cell_ += size == 0 ? 0 : (size - 1) / width_ * width_;
        } else {
            throw std::runtime_error("above the first row");
        }
    }
    void down() {
        if (++line_ == lines_.size()) lines_.emplace_back();
        cell_ = 0;
        is_behind_ = false;
    }
    void erase_below() {
        lines_[line_].resize(std::min(lines_[line_].size(), cell_));
        lines_.resize(line_ + 1);
    }
    void put(const std::string& character) {
        auto& line = lines_[line_];
        // What the tests write: combining accents, Chinese, and else what takes one column.
        if (character == "\xcc\x81") {
            line.at(cell_ - 1) += character;
            return;
        }
        const bool wide = character >= "\xe4\xb8\x80" && character <= "\xe9\xbf\xbf";
        const std::size_t columns = wide ? 2 : 1;
        if (line.size() < cell_ + columns) line.resize(cell_ + columns, " ");
        line[cell_] = character;
        if (wide) line[cell_ + 1] = "";
        cell_ += columns;
        is_behind_ = true;
    }

    std::size_t width_;
    std::vector<std::vector<std::string>> lines_{1};
    std::size_t line_ = 0;
    std::size_t cell_ = 0;
    bool is_behind_ = false;  ///< a character
};

/// A terminal of the system whose other end is read into a Screen.
class Terminal {
  public:
    Terminal(int columns, int rows) : screen_(static_cast<std::size_t>(columns)) {
        winsize size = size_of(columns, rows);
        int program_end = -1;
        if (openpty(&our_end_, &program_end, nullptr, nullptr, &size) != 0)
            throw std::runtime_error("no terminal");
        file_ = fdopen(program_end, "w");
        reader_ = std::thread([this] { read_all(); });
    }
    ~Terminal() {
        close_program_end();
        close(our_end_);
    }
    Terminal(const Terminal&) = delete;
    Terminal& operator=(const Terminal&) = delete;

    std::FILE* file() const { return file_; }

    void resize(int columns, int rows) {
        const std::lock_guard lock(mutex_);
        const winsize size = size_of(columns, rows);
        ioctl(our_end_, TIOCSWINSZ, &size);
        screen_.resize(static_cast<std::size_t>(columns));
    }

    /// Waits until a text is shown on the last row, and returns what is shown then.
    std::vector<std::string> rows_when_last_has(const std::string& text) {
        for (int i = 0; i < 48'000; ++i) {  // minutes, on a busy machine
            {
                const std::lock_guard lock(mutex_);
                const std::vector<std::string> rows = screen_.rows();
                if (!rows.empty() && rows.back().find(text) != std::string::npos &&
                    screen_.cursor_is_at_the_end())
                    return rows;
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        throw std::runtime_error("never shown: " + text);
    }

    /// What remains when the program has closed the terminal.
    Screen end() {
        close_program_end();
        return screen_;
    }
    std::string bytes() const { return bytes_; }

  private:
    static winsize size_of(int columns, int rows) {
        return {.ws_row = static_cast<unsigned short>(rows),
                .ws_col = static_cast<unsigned short>(columns),
                .ws_xpixel = 0,
                .ws_ypixel = 0};
    }
    void read_all() {
        std::array<char, 4096> buffer{};
        while (true) {
            const ssize_t count = read(our_end_, buffer.data(), buffer.size());
            // EIO says that nobody has the other end any more.
            if (count <= 0) return;
            const std::lock_guard lock(mutex_);
            bytes_.append(buffer.data(), static_cast<std::size_t>(count));
            pending_.append(buffer.data(), static_cast<std::size_t>(count));
            // A sequence or a character may have come in halves; a frame ends with neither.
            const std::size_t whole = whole_part(pending_);
            screen_.take(pending_.substr(0, whole));
            pending_.erase(0, whole);
        }
    }
    static std::size_t whole_part(const std::string& text) {
        std::size_t end = text.size();
        const std::size_t escape = text.rfind('\x1b');
        if (escape != std::string::npos && text.find_first_of("AJm", escape) == std::string::npos)
            end = escape;
        for (std::size_t back = 1; back <= 3 && back <= end; ++back) {
            const auto byte = static_cast<unsigned char>(text[end - back]);
            if (byte < 0x80) break;
            if (byte < 0xC0) continue;
            const std::size_t wanted = byte < 0xE0 ? 2 : byte < 0xF0 ? 3 : 4;
            return wanted > back ? end - back : end;
        }
        return end;
    }
    void close_program_end() {
        if (file_ == nullptr) return;
        std::fclose(file_);
        file_ = nullptr;
        reader_.join();
    }

    int our_end_ = -1;
    std::FILE* file_ = nullptr;
    std::mutex mutex_;
    Screen screen_;
    std::string bytes_;
    std::string pending_;
    std::thread reader_;
};

}  // namespace runcert::test
