// The tables of the database. What they mean stands in server/README.md.
#pragma once

namespace hairbake {

inline constexpr int schema_version = 1;

/// Statements that make all tables in an empty database.
const char* schema_statements();

}  // namespace hairbake
