// The tables of the database. What they mean stands in server/README.md.
#pragma once

namespace hairbake {

inline constexpr int schema_version = 4;

/// Statements that bring a database of the version `from` to `from` + 1; version 0 is an empty one.
const char* schema_statements(int from);

}  // namespace hairbake
