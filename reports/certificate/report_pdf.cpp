#include <fcntl.h>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/pdf_making.h"
#include "store/atomic_file.h"
#include "store/base64.h"

namespace runcert {
namespace {

constexpr const char* page_name = "report.html";
constexpr const char* pdf_name = "report.pdf";

/// The PDF with the dates of what is attached to it set to 1970. WeasyPrint 62 takes them from the
/// clock whatever SOURCE_DATE_EPOCH says, and the same report must give the same bytes.
std::string without_dates(std::string pdf) {
    constexpr std::string_view epoch = "19700101000000Z";
    for (const std::string_view key : {"/CreationDate (D:", "/ModDate (D:"})
        for (std::size_t at = pdf.find(key); at != std::string::npos; at = pdf.find(key, at)) {
            at += key.size();
            if (pdf.find(')', at) == at + epoch.size()) pdf.replace(at, epoch.size(), epoch);
        }
    return pdf;
}

/// Whether a text holds nothing that is written from right to left, which begins with other bytes
/// of UTF-8 than Latin, Greek, Cyrillic and punctuation.
bool runs_to_the_right(std::string_view text) {
    return std::ranges::none_of(text, [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return byte >= 0xD6 && byte != 0xE2;
    });
}

/// The page without what costs WeasyPrint a quarter of its time: blanks between lines of tags, the
/// isolation of texts that need none, and drawings as elements that every rule of style is tried
/// on.
std::string lightened(std::string_view html) {
    constexpr std::string_view begin = "<bdi>", end = "</bdi>", drawing = "<svg xmlns=";
    std::string light;
    while (!html.empty()) {
        std::size_t taken = 1;
        if (html.starts_with(">\n")) {
            taken = std::min(html.find_first_not_of(" \n", 1), html.size());
            light += taken < html.size() && html[taken] == '<' ? ">" : ">\n";
        } else if (const std::size_t close = html.starts_with(begin) ? html.find(end) : html.npos;
                   close != html.npos &&
                   runs_to_the_right(html.substr(begin.size(), close - begin.size()))) {
            light += html.substr(begin.size(), close - begin.size());
            taken = close + end.size();
        } else if (html.starts_with(drawing)) {
            taken = html.find("</svg>") + 6;
            const std::size_t label = html.find("aria-label=\"") + 12;
            light += fmt::format("<img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"/>",
                                 html.substr(label, html.find('"', label) - label),
                                 base64(std::string(html.substr(0, taken))));
        } else {
            light += html.front();
        }
        html.remove_prefix(taken);
    }
    return light;
}

}  // namespace

PdfMaking::PdfMaking() {
    begin();
}

PdfMaking::~PdfMaking() {
    stop_.request_stop();
}

/// It reads the page from a FIFO, once there is one.
void PdfMaking::begin() {
    const std::filesystem::path page = folder_.path() / page_name;
    std::filesystem::remove(page);
    if (mkfifo(page.c_str(), S_IRUSR | S_IWUSR) != 0)
        throw Failure(page.string(), std::strerror(errno), "Leave the PDF out with --no-pdf");
    // Open for reading, too, so that writing to a program that has ended is no signal.
    page_ = FileDescriptor(open(page.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    // Tagged, for those who have it read to them: WeasyPrint 57 takes one variant of PDF, so that
    // PDF/A, for archives, is not to be had beside it. It writes the time of making into the file
    // unless it is told another.
    call_ = {.command = {"weasyprint", "--quiet", "--encoding", "utf-8", "--pdf-variant",
                         "pdf/ua-1", "--attachment", "report.json", page_name, pdf_name},
             .folder = folder_.path(),
             .environment = {{"SOURCE_DATE_EPOCH", "0"}},
             .stop = stop_.get_token()};
    result_ = std::async(std::launch::async, [this] { return run_external(call_); });
}

bool PdfMaking::has_ended() const {
    return result_.wait_for(std::chrono::milliseconds(1)) == std::future_status::ready;
}

/// Until all was taken out again, or nobody is left who would.
void PdfMaking::give(std::string_view page) {
    for (int unread = 0; (!page.empty() || unread > 0) && !has_ended();) {
        const ssize_t taken = write(page_.number(), page.data(), page.size());
        if (taken > 0) page.remove_prefix(static_cast<std::size_t>(taken));
        ioctl(page_.number(), FIONREAD, &unread);
    }
    page_ = {};
}

std::string PdfMaking::pdf(const std::string& html, const std::string& report_text) {
    write_file_atomically(folder_.path() / "report.json", report_text);
    if (has_ended()) begin();  // it may have waited for too long
    give(lightened(html));
    ProcessResult result = result_.get();
    const std::filesystem::path pdf = folder_.path() / pdf_name;
    if (result.exit_status != 0 || !std::filesystem::exists(pdf)) {
        // Of a traceback, the last line says what was wrong.
        const std::string_view said = trim(result.errors);
        result.errors = said.substr(said.find_last_of('\n') + 1);
        throw Failure(
            "weasyprint",
            fmt::format("the PDF could not be made: {}", external_problem(call_, result)),
            "Install the package weasyprint again, or leave the PDF out with --no-render");
    }
    return without_dates(read_file(pdf));
}

}  // namespace runcert
