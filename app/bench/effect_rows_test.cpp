#include "app/bench/effect_rows.h"
#include "app/bench/trades.h"
#include "perception/model.h"

#include <gtest/gtest.h>

namespace entoptic::app {
namespace {

// A trade that no model has, or with values that none allows, would silently not be measured.
TEST(Bench, EveryTradeIsAParameterOfAModelThatAllowsItsValues) {
    for (const Trade& trade : trades()) {
        int models = 0;
        for (const perception::ModelEntry* entry : perception::models()) {
            if (entry->slot != trade.slot || (!trade.model.empty() && entry->name != trade.model)) continue;
            for (const perception::ParameterInfo& p : entry->parameters) {
                if (p.name != trade.parameter) continue;
                int allowed = 0;
                for (const double value : trade.values) allowed += p.allows(value);
                EXPECT_GE(allowed, 2) << entry->name << " " << trade.parameter;
                ++models;
            }
        }
        EXPECT_GE(models, 1) << trade.slot << " " << trade.model << " " << trade.parameter;
    }
}

EffectRow row(const char* setting, double ms, double p99, double mean, bool chosen = false) {
    EffectRow made;
    made.effect = "glare";
    made.model = "cie135";
    made.setting = setting;
    made.is_chosen = chosen;
    made.time_ms = {ms, ms, ms, ms};
    made.error.de_itp_p99 = p99;
    made.error.de_itp_mean = mean;
    return made;
}
std::string fastest(std::vector<EffectRow> rows) {
    mark_fastest(rows);
    std::string names;
    for (const EffectRow& r : rows)
        if (r.is_fastest_unseen) names += r.setting + ";";
    return names;
}

TEST(Bench, TheFastestUnseenRowIsMarked) {
    EXPECT_EQ(fastest({row("default", 10, 0.5, 0.1, true), row("fast", 5, 0.9, 0.19), row("faster", 1, 1.1, 0.1),
                       row("fastest", 0.5, 0.1, 0.21)}),
              "fast;");
    EXPECT_EQ(fastest({row("default", 10, 0.5, 0.1, true), row("hardly", 9.9, 0.5, 0.1)}), "default;") << "less than a twentieth is noise";
    EXPECT_EQ(fastest({row("default", 10, 5, 1, true), row("other", 1, 2, 1)}), "") << "none is unseen";
    // Rows that describe another eye are compared among themselves.
    std::vector<EffectRow> rows{row("default", 10, 0.5, 0.1, true), row("zones=1", 1, 0.5, 0.1), row("zones=3", 3, 0.5, 0.1)};
    for (std::size_t i = 1; i < rows.size(); ++i) rows[i].apart = true, rows[i].parameter = "zones";
    EXPECT_EQ(fastest(rows), "default;zones=1;");
}

TEST(Bench, ErrorsOfPicturesAreThoseOfTheDisplay) {
    ImageF wanted(10, 10, 3, 20.0f), got = wanted;
    EXPECT_TRUE(picture_error(got, wanted).is_unseen());
    EXPECT_EQ(picture_error(got, wanted).max_code, 0);
    // One pixel in a hundred is not yet the 99th percentile; above white nothing differs.
    got.data[0] = got.data[1] = got.data[2] = 100;
    EXPECT_EQ(picture_error(got, wanted).de_itp_p99, 0);
    EXPECT_NEAR(picture_error(got, wanted).energy, 0.04, 1e-6);
    ImageF bright(10, 10, 3, 1e4f), brighter(10, 10, 3, 1e6f);
    EXPECT_EQ(picture_error(brighter, bright).energy, 0);
    const Percentiles times = percentiles({3, 1, 2, 10});
    EXPECT_EQ(times.median, 2);
    EXPECT_EQ(times.p95, 10);
    EXPECT_EQ(times.mean, 4);
    EXPECT_EQ(times.least, 1);
}

}  // namespace
}  // namespace entoptic::app
