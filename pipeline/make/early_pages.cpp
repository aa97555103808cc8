#include "make/early_pages.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <future>

#include "run/attempt_files.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* whole_page = "report.pdf";

}  // namespace

/// The step "render" that waits on its standard input for the report.
class EarlyPages::Waiting {
  public:
    Waiting(const fs::path& run_dir, const std::vector<std::string>& pages) {
        std::array<int, 2> ends{};
        if (pipe2(ends.data(), O_CLOEXEC) != 0)
            fail_of_system(run_dir, "cannot start what draws the pages", errno);
        input_ = FileDescriptor(ends[0]);
        begin_ = FileDescriptor(ends[1]);
        const StepCall call{.attempt = run_dir / attempt_copy_name,
                            .run_dir = run_dir,
                            .pages = pages,
                            .waits = true};
        ProcessOptions options{.environment = {synced_by_caller()}};
        options.standard_input = fmt::format("/proc/self/fd/{}", input_.number());
        done_ = std::async(std::launch::async,
                           [call, options] { return run_step("render", call, options); });
    }
    /// The report is there.
    void begin() { (void)write(begin_.number(), "\n", 1); }
    StageDone drawn() { return done_.get(); }

  private:
    FileDescriptor input_;
    std::future<StageDone> done_;
    FileDescriptor begin_;  // closed first: a program that waits ends
};

EarlyPages::EarlyPages(const fs::path& run_dir, const std::vector<std::string>& pages)
    : run_dir_(run_dir),
      first_pages_(pages),
      has_whole_(std::ranges::find(pages, whole_page) != pages.end()) {
    std::erase(first_pages_, whole_page);
    first_ = std::make_unique<Waiting>(run_dir, first_pages_);
}

EarlyPages::~EarlyPages() = default;

void EarlyPages::expect_whole() {
    if (has_whole_ && !whole_)
        whole_ = std::make_unique<Waiting>(folder_.path(), std::vector<std::string>{whole_page});
}

StageDone EarlyPages::draw() {
    expect_whole();
    if (whole_) {
        take_report(run_dir_, folder_.path());
        fs::copy_file(run_dir_ / attempt_copy_name, folder_.path() / attempt_copy_name);
        whole_->begin();
    }
    first_->begin();
    StageDone done = first_->drawn();
    done.wrote = first_pages_;
    return done;
}

bool EarlyPages::put_whole_into(const fs::path& run_dir) {
    if (!whole_) return false;
    whole_->drawn();
    write_file_atomically(run_dir / whole_page, read_file(folder_.path() / whole_page));
    return true;
}

}  // namespace runcert
