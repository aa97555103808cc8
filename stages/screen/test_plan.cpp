#include "stages/screen/test_plan.h"

#include <cmath>
#include <iterator>

#include "core/statistics.h"

namespace runcert {

TestPlan::TestPlan(double family_false_alarm_rate, std::int64_t tests, double power,
                   std::int64_t burst_epochs_max, double manoeuvre_max_m_s2)
    : tests_(tests),
      size_(family_false_alarm_rate / static_cast<double>(tests)),
      power_(power),
      burst_epochs_max_(static_cast<std::size_t>(burst_epochs_max)),
      manoeuvre_max_m_s2_(manoeuvre_max_m_s2),
      noncentrality_{0.0, runcert::noncentrality(size_, power, 1),
                     runcert::noncentrality(size_, power, 2)} {
    for (const int axes : {1, 2})
        critical(axes);
}

double TestPlan::critical(int degrees_of_freedom) const {
    const auto index = static_cast<std::size_t>(degrees_of_freedom);
    if (critical_.size() <= index) critical_.resize(index + 1, 0.0);
    if (critical_[index] == 0.0)
        critical_[index] = chi_squared_upper_quantile(size_, degrees_of_freedom);
    return critical_[index];
}

std::int64_t tests_of_an_epoch(std::int64_t burst_epochs_max) {
    const std::int64_t of_axes = 5 + (burst_epochs_max - 1) + std::ssize(span_lengths);
    constexpr std::int64_t series = 2 + 2;  // horizontal, vertical; baseline across and in length
    constexpr std::int64_t witnesses = 2 + 3;  // velocities from both sides; three limits
    return series * of_axes + witnesses;
}

}  // namespace runcert
