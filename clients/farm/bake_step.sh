#!/bin/sh
# A step of any build farm: has one groom baked by a service and leaves the result in a folder.
#
#   bake_step.sh GROOM ENVIRONMENT OUT [further flags of hairbake submit]
#
# The farm sets HAIRBAKE_SERVER, and HAIRBAKE_TOKEN_FILE as a secret file. The step can be repeated at any time:
# files are not sent again, bakes are not computed again, and results are not fetched again. The last line of its output
# sums up the work. Exit codes are those of hairbake: after 6 (server unreachable) try again later; 3 and 8 are faults
# of the groom.
#
#   Jenkins         withCredentials([file(credentialsId: 'hairbake', variable: 'HAIRBAKE_TOKEN_FILE')]) {
#                       sh 'clients/farm/bake_step.sh groom.hair sky.hdr baked' }
#   GitHub Actions  - run: clients/farm/bake_step.sh groom.hair sky.hdr baked
#                     env: {HAIRBAKE_SERVER: "https://bake.example", HAIRBAKE_TOKEN_FILE: "${{ runner.temp }}/token"}
#   TeamCity        a Command Line step with the same line; server and token file as parameters env.HAIRBAKE_*
#   Horde           <Spawn Exe="/bin/sh" Arguments="clients/farm/bake_step.sh groom.hair sky.hdr baked" />
set -eu
[ $# -ge 3 ] || { echo "usage: $0 GROOM ENVIRONMENT OUT [flags of hairbake submit]" >&2; exit 2; }
: "${HAIRBAKE_SERVER:?is the address of the service}"
groom=$1 environment=$2 out=$3
shift 3
exec "${HAIRBAKE:-hairbake}" submit --hair "$groom" --env "$environment" --wait --fetch "$out" --progress none "$@"
