<?php
// PHP's curl as a client. README.md in this folder describes the commands.

const MEDIA_TYPE = 'Content-Type: model/obj';

/** Sends a request of the handle, and prints what came. */
function report(string $style, CurlHandle $handle, string $url, array $options): void
{
    curl_setopt_array($handle, $options + [CURLOPT_URL => $url, CURLOPT_POST => true, CURLOPT_RETURNTRANSFER => true]);
    $body = curl_exec($handle);
    print_result($style, $handle, $body === false ? null : $body);
}

function print_result(string $style, CurlHandle $handle, ?string $body): void
{
    $is_lost = $body === null || curl_errno($handle) !== 0;
    $status = $is_lost ? 'lost' : curl_getinfo($handle, CURLINFO_RESPONSE_CODE);
    $rest = $is_lost ? curl_error($handle) : hash('sha256', $body);
    // The processes share the output, so that each line must be written at once.
    fwrite(STDOUT, "PHP, $style | $status | $rest\n");
}

function upload(string $url, string $path): void
{
    $handle = curl_init();
    $mesh = file_get_contents($path);
    report('whole', $handle, $url, [CURLOPT_POSTFIELDS => $mesh, CURLOPT_HTTPHEADER => [MEDIA_TYPE]]);
    report('form', $handle, $url, [CURLOPT_POSTFIELDS => ['mesh' => new CURLFile($path)], CURLOPT_HTTPHEADER => []]);
    $file = fopen($path, 'rb');
    report('stream', curl_init(), $url, [
        CURLOPT_HTTPHEADER => [MEDIA_TYPE, 'Transfer-Encoding: chunked'],
        CURLOPT_READFUNCTION => fn ($handle, $unused, $length) => (string) fread($file, $length),
    ]);
}

/** Each connection is a process, since PHP has no threads. */
function pause(string $url, string $path, float $seconds, int $rounds, int $connections): void
{
    $mesh = file_get_contents($path);
    for ($number = 0; $number < $connections; ++$number) {
        if (pcntl_fork() === 0) {
            $handle = curl_init();
            for ($round = 0; $round <= $rounds; ++$round) {
                if ($round > 0) {
                    usleep((int) ($seconds * 1e6));
                }
                report('pause', $handle, $url, [CURLOPT_POSTFIELDS => $mesh, CURLOPT_HTTPHEADER => [MEDIA_TYPE]]);
            }
            exit(0);
        }
    }
    while (pcntl_wait($status) > 0) {
    }
}

function early(string $url, int $size, int $rate): void
{
    $began = microtime(true);
    $given = 0;
    $next = function ($handle, $unused, $length) use ($size, $rate, $began, &$given): string {
        usleep((int) max(0, ($began + $given / $rate - microtime(true)) * 1e6));
        $count = min($length, $size - $given);
        $given += $count;
        return str_repeat('#', $count);
    };
    report('stream', curl_init(), $url, [
        CURLOPT_HTTPHEADER => [MEDIA_TYPE, 'Transfer-Encoding: chunked'],
        CURLOPT_READFUNCTION => $next,
    ]);
}

[, $command, $url] = $argv;
match ($command) {
    'upload' => upload($url, $argv[3]),
    'pause' => pause($url, $argv[3], (float) $argv[4], (int) $argv[5], (int) $argv[6]),
    'early' => early($url, (int) $argv[3], (int) $argv[4]),
};
