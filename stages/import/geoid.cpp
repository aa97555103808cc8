#include "stages/import/geoid.h"

#include <fmt/format.h>
#include <proj.h>

#include <array>
#include <limits>

#include "core/angle.h"
#include "core/failure.h"
#include "store/sha256.h"

namespace runcert {

/// What PROJ gives and takes back.
struct Geoid::Handles {
    PJ_CONTEXT* context = proj_context_create();
    PJ* shift = nullptr;

    Handles() = default;
    ~Handles() {
        proj_destroy(shift);
        proj_context_destroy(context);
    }
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
};

Geoid::Geoid(GeoidModel model) : handles_(std::make_unique<Handles>()) {
    // Under the name that this or that release of PROJ has it.
    constexpr std::array names{"egm96_15.gtx", "us_nga_egm96_15.tif"};
    proj_context_set_enable_network(handles_->context, 0);
    for (const char* name : names) {
        if (handles_->shift != nullptr) break;
        handles_->shift =
            proj_create(handles_->context,
                        fmt::format("+proj=vgridshift +multiplier=1 +grids={}", name).c_str());
        grid_ = proj_grid_info(name).filename;
    }
    if (handles_->shift == nullptr)
        throw Failure("PROJ",
                      fmt::format("the grid of the geoid {} is not installed", to_text(model)),
                      "Install it (package proj-data), or give ellipsoidal heights");
}

Geoid::~Geoid() = default;

double Geoid::height_m(double latitude_deg, double longitude_deg) const {
    const PJ_COORD at = proj_coord(Angle::from_degrees(longitude_deg).radians(),
                                   Angle::from_degrees(latitude_deg).radians(), 0.0, 0.0);
    return proj_trans(handles_->shift, PJ_FWD, at).xyz.z;
}

void raise_heights(StreamedRecording& recording, const Receiver& receiver) {
    if (!receiver.height_reference) return;
    if (!recording.head.facts.georeferenced)
        throw Failure(receiver.place,
                      "its heights are counted from its own origin, and not above a geoid",
                      "Remove height_reference");
    const auto geoid = std::make_shared<Geoid>(receiver.height_reference->geoid);
    double least_m = std::numeric_limits<double>::infinity(), most_m = -least_m;
    recording.give = [geoid, give = std::move(recording.give)](const TakeRow& take) {
        give([&](Observation& row) {
            if (row.height_m && row.latitude_deg && row.longitude_deg)
                row.height_m =
                    *row.height_m + geoid->height_m(*row.latitude_deg, *row.longitude_deg);
            take(row);
        });
    };
    recording.give([&](const Observation& row) {
        if (!row.height_m) return;
        const double raised_m = geoid->height_m(*row.latitude_deg, *row.longitude_deg);
        least_m = std::min(least_m, raised_m);
        most_m = std::max(most_m, raised_m);
    });
    recording.head.header.programs.push_back({.name = "PROJ, " + geoid->grid().filename().string(),
                                              .version = proj_info().version,
                                              .sha256 = digest_file(geoid->grid()).sha256});
    recording.head.notes.push_back(fmt::format(
        "Heights were recorded above mean sea level, as the attempt says. They were made "
        "ellipsoidal by the geoid {}, which lies {:.2f} m to {:.2f} m above the "
        "ellipsoid there.",
        to_text(receiver.height_reference->geoid), least_m, most_m));
}

}  // namespace runcert
