#include "server/store/schema.h"

#include <array>

namespace hairbake {
namespace {

// Times are seconds since 1970. Digests and keys are 64 hexadecimal digits. Requests, facts, errors and manifests are
// JSON.
constexpr const char* version_1 = R"sql(
CREATE TABLE blobs(sha256 TEXT PRIMARY KEY, bytes INTEGER NOT NULL, created REAL NOT NULL, used REAL NOT NULL)
    WITHOUT ROWID;
CREATE TABLE inputs(seq INTEGER PRIMARY KEY, kind TEXT NOT NULL, sha256 TEXT NOT NULL, facts TEXT NOT NULL,
    thumbnail TEXT, created REAL NOT NULL, UNIQUE(kind, sha256));
CREATE TABLE names(kind TEXT NOT NULL, path TEXT NOT NULL, version INTEGER NOT NULL, sha256 TEXT NOT NULL,
    note TEXT NOT NULL, token TEXT NOT NULL, created REAL NOT NULL, PRIMARY KEY(kind, path, version)) WITHOUT ROWID;
CREATE INDEX names_by_blob ON names(sha256);

CREATE TABLE stages(seq INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, kind TEXT NOT NULL, core_key TEXT NOT NULL,
    state TEXT NOT NULL, request TEXT NOT NULL, priority INTEGER NOT NULL, attempts INTEGER NOT NULL,
    crashes INTEGER NOT NULL, error TEXT, manifest TEXT, created REAL NOT NULL, started REAL, finished REAL);
CREATE INDEX stages_by_state ON stages(state, priority DESC, seq);
CREATE TABLE stage_inputs(stage TEXT NOT NULL, sha256 TEXT NOT NULL, PRIMARY KEY(stage, sha256)) WITHOUT ROWID;
CREATE INDEX stage_inputs_by_blob ON stage_inputs(sha256);
CREATE TABLE stage_files(stage TEXT NOT NULL, name TEXT NOT NULL, sha256 TEXT NOT NULL, bytes INTEGER NOT NULL,
    PRIMARY KEY(stage, name)) WITHOUT ROWID;
CREATE INDEX stage_files_by_blob ON stage_files(sha256);

CREATE TABLE bakes(seq INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, state TEXT NOT NULL, request TEXT NOT NULL,
    names TEXT NOT NULL, hair TEXT, environment TEXT, priority INTEGER NOT NULL, transmittance TEXT, irradiance TEXT,
    attempts INTEGER NOT NULL, error TEXT, created REAL NOT NULL, finished REAL);
CREATE INDEX bakes_by_state ON bakes(state, seq);
CREATE INDEX bakes_by_transmittance ON bakes(transmittance, state);
CREATE INDEX bakes_by_irradiance ON bakes(irradiance, state);
CREATE INDEX bakes_by_hair ON bakes(hair, seq);
CREATE INDEX bakes_by_environment ON bakes(environment, seq);
CREATE TABLE batches(seq INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, request TEXT NOT NULL, created REAL NOT NULL);
CREATE TABLE batch_bakes(batch TEXT NOT NULL, bake TEXT NOT NULL, PRIMARY KEY(batch, bake)) WITHOUT ROWID;
CREATE INDEX batch_bakes_by_bake ON batch_bakes(bake);

CREATE TABLE uploads(id TEXT PRIMARY KEY, bytes INTEGER NOT NULL, sha256 TEXT NOT NULL, metadata TEXT NOT NULL,
    created REAL NOT NULL, expires REAL NOT NULL) WITHOUT ROWID;
)sql";

constexpr const char* version_2 = "ALTER TABLE uploads ADD COLUMN token TEXT NOT NULL DEFAULT ''";

constexpr const char* version_3 = R"sql(
CREATE TABLE bake_names(bake TEXT NOT NULL, field TEXT NOT NULL, path TEXT NOT NULL, version INTEGER NOT NULL,
    PRIMARY KEY(bake, field, path)) WITHOUT ROWID;
CREATE INDEX bake_names_by_path ON bake_names(path);
INSERT INTO bake_names SELECT b.id, n.key, json_extract(n.value, '$.path'), json_extract(n.value, '$.version')
    FROM bakes b, json_each(b.names) n;
)sql";

// The age of a bake, so that one page of a name's or a batch's bakes is read without all others.
constexpr const char* version_4 = R"sql(
DELETE FROM bake_names WHERE bake NOT IN (SELECT id FROM bakes);
ALTER TABLE bake_names ADD COLUMN seq INTEGER NOT NULL DEFAULT 0;
UPDATE bake_names SET seq = (SELECT b.seq FROM bakes b WHERE b.id = bake);
DROP INDEX bake_names_by_path;
CREATE INDEX bake_names_by_path ON bake_names(path, seq);
DELETE FROM batch_bakes WHERE bake NOT IN (SELECT id FROM bakes);
ALTER TABLE batch_bakes ADD COLUMN seq INTEGER NOT NULL DEFAULT 0;
UPDATE batch_bakes SET seq = (SELECT b.seq FROM bakes b WHERE b.id = bake);
CREATE INDEX batch_bakes_by_age ON batch_bakes(batch, seq);
CREATE INDEX inputs_by_blob ON inputs(sha256);
CREATE INDEX inputs_by_thumbnail ON inputs(thumbnail);
)sql";

// Any number of stages a bake (version 4 had a column for each of two); bake_stages.bake is bakes.seq. The run of a
// stage on a runner that survives a restart.
constexpr const char* version_5 = R"sql(
CREATE TABLE bake_stages(seq INTEGER PRIMARY KEY, bake INTEGER NOT NULL, kind TEXT NOT NULL, stage TEXT NOT NULL,
    UNIQUE(bake, kind));
INSERT INTO bake_stages(bake, kind, stage)
    SELECT seq, 'transmittance', transmittance FROM bakes WHERE transmittance IS NOT NULL ORDER BY seq;
INSERT INTO bake_stages(bake, kind, stage)
    SELECT seq, 'irradiance', irradiance FROM bakes WHERE irradiance IS NOT NULL ORDER BY seq;
CREATE INDEX bake_stages_by_stage ON bake_stages(stage, bake);
DROP INDEX bakes_by_transmittance;
DROP INDEX bakes_by_irradiance;
ALTER TABLE bakes DROP COLUMN transmittance;
ALTER TABLE bakes DROP COLUMN irradiance;
ALTER TABLE stages ADD COLUMN runner TEXT;
ALTER TABLE stages ADD COLUMN handle TEXT;
ALTER TABLE stages ADD COLUMN work_folder TEXT;
)sql";

// The identity of the store (store_identity.h): one row. Blobs whose removal was committed, whose files may still be
// there. The times of a blob's file when its digest was right (nanoseconds since 1970; 0: unknown), and when its digest
// was last checked.
constexpr const char* version_6 = R"sql(
CREATE TABLE store(id TEXT NOT NULL, generation INTEGER NOT NULL, accepted INTEGER NOT NULL);
INSERT INTO store VALUES(lower(hex(randomblob(16))), 0, 0);
CREATE TABLE removals(sha256 TEXT PRIMARY KEY, time REAL NOT NULL) WITHOUT ROWID;
ALTER TABLE blobs ADD COLUMN mtime_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE blobs ADD COLUMN ctime_ns INTEGER NOT NULL DEFAULT 0;
ALTER TABLE blobs ADD COLUMN checked REAL NOT NULL DEFAULT 0;
)sql";

// Blobs that a client sent: they are never evicted. Of an older store these are the blobs that are used as inputs, and
// those that are neither results nor thumbnails.
constexpr const char* version_7 = R"sql(
CREATE TABLE sent_blobs(sha256 TEXT PRIMARY KEY) WITHOUT ROWID;
INSERT INTO sent_blobs SELECT sha256 FROM blobs WHERE sha256 IN (SELECT sha256 FROM inputs) OR
    sha256 IN (SELECT sha256 FROM stage_inputs) OR sha256 IN (SELECT sha256 FROM names) OR NOT (
    sha256 IN (SELECT sha256 FROM stage_files) OR
    sha256 IN (SELECT thumbnail FROM inputs WHERE thumbnail IS NOT NULL));
CREATE TRIGGER forget_sent_blob AFTER DELETE ON blobs BEGIN DELETE FROM sent_blobs WHERE sha256 = OLD.sha256; END;
)sql";

// The deaths of a stage's workers that count (jobs/stage_deaths.h), and how often a daemon ended while the stage ran.
// Bakes whose rows were removed, with the state that they had: those of evicted results, and old failed and cancelled
// ones.
constexpr const char* version_8 = R"sql(
ALTER TABLE stages ADD COLUMN deaths TEXT;
ALTER TABLE stages ADD COLUMN ends INTEGER NOT NULL DEFAULT 0;
CREATE TABLE forgotten_bakes(seq INTEGER PRIMARY KEY, id TEXT NOT NULL UNIQUE, state TEXT NOT NULL, time REAL NOT NULL);
)sql";

constexpr std::array<const char*, schema_version> changes{version_1, version_2, version_3, version_4,
                                                          version_5, version_6, version_7, version_8};

}  // namespace

const char* schema_statements(int from) { return changes.at(static_cast<std::size_t>(from)); }

}  // namespace hairbake
