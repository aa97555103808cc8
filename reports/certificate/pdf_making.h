#pragma once

#include <future>
#include <stop_token>
#include <string>
#include <string_view>

#include "store/external_program.h"
#include "store/folder.h"
#include "store/process.h"

namespace runcert {

/// One PDF, by WeasyPrint, which is started at once: starting takes it longer than drawing one
/// page, and can be done while there is no page yet.
class PdfMaking {
  public:
    PdfMaking();
    ~PdfMaking();
    PdfMaking(const PdfMaking&) = delete;
    PdfMaking& operator=(const PdfMaking&) = delete;

    /// The page on A4 paper, as the bytes of a PDF file, with `report_text` attached as
    /// report.json; the same page gives the same bytes. To be called once. Failure where WeasyPrint
    /// is missing or fails.
    std::string pdf(const std::string& html, const std::string& report_text);

  private:
    void begin();
    bool has_ended() const;
    void give(std::string_view page);

    TemporaryFolder folder_;
    FileDescriptor page_;
    ExternalCall call_;
    std::stop_source stop_;
    std::future<ProcessResult> result_;
};

}  // namespace runcert
