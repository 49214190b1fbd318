// The tables of the database. docs/architecture.md tells what they mean.
//
// To change a table: raise schema_version, let schema_statements() of the previous version make the change, leave all
// earlier statements as they are, extend tests/server/test_migration.py, and record the version in CHANGELOG.md.
#pragma once

namespace hairbake {

inline constexpr int schema_version = 8;

/// Statements that bring a database of version `from`, in [0, schema_version), to version `from` + 1. Version 0 is an
/// empty database.
const char* schema_statements(int from);

}  // namespace hairbake
