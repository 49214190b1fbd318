// The estimate of the time that a command will still take.
#pragma once

#include <algorithm>

namespace hairbake {

/// A person trusts a time that falls. It rises by at most a tenth of what was shown, once a second.
class TimeLeft {
public:
    /// elapsed:  seconds since the beginning; must not fall
    /// fraction: of the work that is done, 0 to 1
    /// Seconds; negative while there is no estimate.
    double update(double elapsed, double fraction) {
        if (!(fraction > 0.02 && elapsed > 0.2)) return -1;
        const double estimate = std::max(least, elapsed * (1 - fraction) / fraction);
        if (shown_ < 0 || estimate <= shown_) {
            shown_ = estimate;
        } else if (elapsed - raised_ >= 1) {
            shown_ = std::min(estimate, most_rise * shown_);
            raised_ = elapsed;
        }
        return fraction < 1 ? shown_ : 0;
    }

private:
    static constexpr double most_rise = 1.1, least = 0.1;
    double shown_ = -1, raised_ = 0;
};

}  // namespace hairbake
