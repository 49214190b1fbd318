#!/usr/bin/env bash
# Builds both images without a Docker engine and bakes a sample through them: docker/check.sh, as root, on Debian 12.
# HAIRBAKE_JOBS: how many compilers run at once. HAIRBAKE_CCACHE: a folder of ccache for the build inside to use.
# All files are in build/container. The images stay there, so that a second run builds only what has changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

die() { echo "docker/check.sh: $*" >&2 && exit 1; }
say() { echo "== $*"; }

[[ $EUID -eq 0 ]] || die "only root can do this"
if [[ -z ${HAIRBAKE_UNSHARED:-} ]]; then
    # In a mount namespace of its own, since the container runtime demands a cgroup file system.
    export HAIRBAKE_UNSHARED=1
    exec unshare -m --propagation private sh -c \
        'umount -R -l /sys/fs/cgroup 2>/dev/null; mount -t cgroup2 -o ro none /sys/fs/cgroup && exec "$@"' sh "$0" "$@"
fi

packages=(buildah podman crun mmdebstrap curl)
dpkg-query -W -f '${db:Status-Status}\n' "${packages[@]}" 2>/dev/null | grep -c '^installed' | grep -qx ${#packages[@]} ||
    DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends -o DPkg::Lock::Timeout=600 "${packages[@]}"

work=$PWD/build/container
port=${HAIRBAKE_PORT:-18000}
mkdir -p "$work"
printf '[storage]\ndriver = "overlay"\ngraphroot = "%s/graph"\nrunroot = "%s/run"\n' "$work" "$work" >"$work/storage.conf"
printf 'unqualified-search-registries = ["docker.io"]\n' >"$work/registries.conf"
export CONTAINERS_STORAGE_CONF=$work/storage.conf CONTAINERS_REGISTRIES_CONF=$work/registries.conf BUILDAH_ISOLATION=chroot

# --- images -----------------------------------------------------------------------------------------------------------

base=docker.io/library/debian:bookworm-slim
if ! buildah inspect --type image "$base" >/dev/null 2>&1; then
    say "making the base image"
    mmdebstrap -q --variant=minbase bookworm "$work/base.tar" /etc/apt/sources.list.d/debian.sources
    container=$(buildah from --pull-never scratch)
    buildah add -q "$container" "$work/base.tar" /
    buildah config --cmd bash --env PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$container"
    buildah commit -q --rm "$container" "$base"
    rm "$work/base.tar"
fi
./dev build page # with the host's node and npm, so that the build inside needs none
for target in nginx hairbaked; do
    say "building the image $target"
    buildah bud -q --isolation chroot --pull-never --format docker --layers --target "$target" \
        ${HAIRBAKE_CCACHE:+-v "$HAIRBAKE_CCACHE:/root/.cache/ccache"} --build-arg "HAIRBAKE_JOBS=${HAIRBAKE_JOBS:-$(nproc)}" \
        -t "localhost/hairbake-$target" -f docker/Dockerfile . >/dev/null
done
buildah images --format '{{.Name}} {{.Size}}' | grep hairbake

# --- a sample through both --------------------------------------------------------------------------------------------

run=(podman run --runtime crun --cgroups=disabled --ulimit nofile=16384:16384 --ulimit nproc=4096:4096
    --no-healthcheck --read-only --tmpfs /tmp --cap-drop=all --security-opt no-new-privileges --pull never)
inside() { "${run[@]}" --rm --network none "$@"; }

clean_up() { podman rm -f -i -t 0 hairbake-check-nginx hairbake-check-daemon >/dev/null 2>&1 || true; }
trap clean_up EXIT
clean_up
rm -rf "$work"/{store,socket,sample,results} && mkdir -p "$work"/{store,socket,sample,results}
chown 10001 "$work"/{store,socket,sample}

say "checking the user and the read-only file systems of the images"
for image in hairbaked nginx; do
    [[ $(inside "localhost/hairbake-$image" id -u) == 10001 ]] || die "$image runs as another user than hairbake"
    ! inside "localhost/hairbake-$image" touch /etc/x 2>/dev/null || die "the root file system of $image can be written"
done

made=$(inside localhost/hairbake-hairbaked hairbaked token new)
token=$(sed -n 's/^token (shown only now): //p' <<<"$made")
{
    cat docker/hairbake.toml
    sed -n '/^\[\[token\]\]/,$p' <<<"$made" | sed 's/^name = "unnamed"/name = "check"/'
} >"$work/hairbake.toml"
sed "s/listen 8000 /listen 127.0.0.1:$port /" docker/nginx-site.conf >"$work/site.conf"
chmod 644 "$work/hairbake.toml" "$work/site.conf"

say "starting both"
"${run[@]}" -d --name hairbake-check-daemon --network none -v "$work/hairbake.toml:/etc/hairbake/hairbake.toml:ro" \
    -v "$work/store:/var/lib/hairbake" -v "$work/socket:/run/hairbaked" localhost/hairbake-hairbaked >/dev/null
"${run[@]}" -d --name hairbake-check-nginx --network host -v "$work/site.conf:/etc/hairbake/site.conf:ro" \
    -v "$work/store:/var/lib/hairbake:ro" -v "$work/socket:/run/hairbaked:ro" localhost/hairbake-nginx >/dev/null
address=http://127.0.0.1:$port
ask() { curl -sSf -H "Authorization: Bearer $token" "$@"; }
for _ in {1..100}; do ! ask -o /dev/null "$address/readyz" 2>/dev/null || break && sleep 0.2; done
ask -o /dev/null "$address/readyz" || die "the service does not answer: $(podman logs hairbake-check-daemon hairbake-check-nginx 2>&1)"

ask "$address/" | grep -q '<title>' || die "the web page is not served"

say "baking the sample"
inside -v "$work/sample:/sample" localhost/hairbake-hairbaked hairbake sample /sample/all >/dev/null
send() {
    local digest
    digest=$(sha256sum "$1" | cut -d' ' -f1)
    ask -o /dev/null -T "$1" "$address/v1/blobs/$digest" && echo "$digest"
}
hair=$(send "$(find "$work/sample/all" -name '*.hair' | sort | head -n 1)")
sky=$(send "$(find "$work/sample/all" -name '*.hdr' -o -name '*.exr' | sort | head -n 1)")
bake=$(ask -H 'Content-Type: application/json' -d "{\"hair\":\"sha256:$hair\",\"environment\":\"sha256:$sky\"}" "$address/v1/bakes" |
    grep -oE '"id":"[0-9a-f]+"' | head -n 1 | cut -d'"' -f4)
for _ in {1..3000}; do
    state=$(ask "$address/v1/bakes/$bake" | grep -oE '"state":"[a-z]+"' | head -n 1 | cut -d'"' -f4)
    [[ $state == queued || $state == running ]] || break
    sleep 0.2
done
[[ $state == done ]] || die "the bake is $state: $(ask "$address/v1/bakes/$bake")"

say "fetching its files"
ask "$address/v1/bakes/$bake" | grep -oE '"name":"[^"]+","sha256":"[0-9a-f]{64}"' | cut -d'"' -f4,8 | tr '"' ' ' >"$work/files"
while read -r name digest; do
    ask -o "$work/results/$name" "$address/v1/bakes/$bake/files/$name"
    echo "$digest  $work/results/$name" | sha256sum -c --quiet || die "$name arrived with another digest"
done <"$work/files"
[[ $(wc -l <"$work/files") -gt 2 ]] || die "the bake has hardly any files: $(cat "$work/files")"

say "stopping"
begin=$(date +%s%N)
podman stop -t 10 hairbake-check-daemon >/dev/null
milliseconds=$((($(date +%s%N) - begin) / 1000000))
[[ $milliseconds -lt 5000 ]] || die "the daemon took $milliseconds ms to stop"
[[ $(podman inspect -f '{{.State.ExitCode}}' hairbake-check-daemon) == 0 ]] || die "the daemon's exit code is not 0"
say "passed: $(wc -l <"$work/files") files of a bake through both containers, stopped in $milliseconds ms"
