#pragma once

#include <optional>
#include <string>

#include "schemas/attempt/attempt.h"
#include "schemas/common/window_span.h"

namespace runcert {

/// What a second method, whose result the attempt states, says of the speed that is judged.
struct DeclaredAgreement {
    std::string method;
    std::string missing;  ///< why it says nothing; empty where it does
    double judged_m_s = 0.0;
    double other_m_s = 0.0;
    double other_expanded_uncertainty_m_s = 0.0;  ///< k = 2
    /// Difference over the root sum of squares of both expanded uncertainties (k = 2); at most 1
    /// means agreement (ISO/IEC 17043).
    double normalised_error = 0.0;

    bool agrees() const { return missing.empty() && normalised_error <= 1.0; }
    bool contradicts() const { return missing.empty() && !agrees(); }
};

/// What a second method that gives a figure says, as part of a sentence.
std::string second_method_text(const DeclaredAgreement& second);

/// A speed that is judged: before the current is taken off, with its window.
struct JudgedSpeed {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
    WindowSpan span;
    bool over_course = false;  ///< from one line of the attempt's course to the other
};

/// Compares with a stated speed; or, over a course, with the speed that declared times at its lines
/// make over its length. Times say nothing of another window, nor of one whose crossings they miss
/// by more than 2 s.
DeclaredAgreement compare_declared(const JudgedSpeed& judged, const SecondaryMethod& method,
                                   const std::optional<Course>& course);

}  // namespace runcert
