#include "reports/export/html_text.h"

#include "core/plain_text.h"

namespace runcert {

std::string html_text(std::string_view text) {
    std::string html;
    for (const char c : plain_text(text)) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                html += c;
        }
    }
    return html;
}

}  // namespace runcert
