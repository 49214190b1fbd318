#include "core/fiber/fiber_model.h"

#include "core/base/error.h"
#include "core/base/short_number.h"

namespace hairbake {
namespace {

/// A NaN is in no range.
void check_numbers(const FiberSettings& settings) {
    for (const FiberNumber& number : fiber_numbers) {
        const double value = number.of(settings);
        if (number.model != settings.model || (value >= number.low && value <= number.high)) continue;
        const std::string field = path_of(number);
        throw Error(ErrorKind::usage,
                    field + " is " + short_number(value) + "; allowed is " + short_number(number.low) + " to " +
                        short_number(number.high),
                    field);
    }
}

std::unique_ptr<const FiberModel> make_unchecked(const FiberSettings& settings) {
    return std::visit([](const auto& parameters) { return make_fiber_model(parameters); },
                      entry_of(settings.model).parameters(settings));
}

/// "kajiya-kay, ...": the models that have maps.
std::string models_with_maps() {
    std::string list;
    for (const FiberModelEntry& entry : fiber_models) {
        FiberSettings settings;
        settings.model = entry.kind;
        if (!make_unchecked(settings)->zonal_kernels()) continue;
        list += (list.empty() ? "" : ", ") + std::string(entry.name);
    }
    return list;
}

}  // namespace

std::unique_ptr<const FiberModel> make_fiber_model(const FiberSettings& settings) {
    check_numbers(settings);
    return make_unchecked(settings);
}

const ZonalKernels& zonal_kernels_for_maps(const FiberModel& model, const FiberSettings& settings) {
    if (const ZonalKernels* kernels = model.zonal_kernels()) return *kernels;
    throw Error(ErrorKind::usage,
                "fiber.model is " + std::string(name_of(settings.model)) +
                    ", which has no irradiance maps yet; allowed for maps is one of " + models_with_maps() +
                    ". The render modes brute, reference and directional take every model",
                "fiber.model");
}

}  // namespace hairbake
