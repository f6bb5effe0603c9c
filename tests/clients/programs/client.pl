# Perl's HTTP::Tiny and LWP as clients. README.md in this folder describes the commands.
use strict;
use warnings;
use Digest::SHA qw(sha256_hex);
use HTTP::Tiny;
use Time::HiRes qw(sleep time);

$| = 1;
my $media_type   = 'model/obj';
my $has_lwp      = eval { require LWP::UserAgent; require LWP::ConnCache; require HTTP::Request::Common; 1 };
my @agent_makers = (\&make_tiny);
if ($has_lwp) { push @agent_makers, \&make_lwp }
else          { print "SKIPPED: Perl has no LWP here\n" }

sub read_file {
    my ($path) = @_;
    open my $file, '<:raw', $path or die "$path: $!";
    local $/;
    return scalar <$file>;
}

# An agent sends a body, which is a string or a function that gives pieces, and returns the status and the bytes.
sub make_tiny {
    my $client = HTTP::Tiny->new(timeout => 60);
    my $send   = sub {
        my ($url, $body) = @_;
        my $answer = $client->post($url, { headers => { 'Content-Type' => $media_type }, content => $body });
        return ($answer->{status} == 599 ? 'lost' : $answer->{status}, $answer->{content});
    };
    return ('HTTP::Tiny', $send);
}

sub make_lwp {
    my $client = LWP::UserAgent->new(timeout => 60, keep_alive => 1);
    my $send   = sub {
        my ($url, $body) = @_;
        my $request = HTTP::Request->new(POST => $url, ['Content-Type' => $media_type], $body);
        my $answer  = $client->request($request);
        my $is_lost = ($answer->header('Client-Warning') // '') eq 'Internal response';
        return ($is_lost ? 'lost' : $answer->code, $answer->content);
    };
    my $send_form = sub {
        my ($url, $path) = @_;
        my $answer = $client->post($url, Content_Type => 'form-data', Content => [mesh => [$path]]);
        return ($answer->code, $answer->content);
    };
    return ('LWP', $send, $send_form);
}

sub report {
    my ($style, $status, $body) = @_;
    my $rest = $status eq 'lost' ? $body =~ s/\s+/ /gr : sha256_hex($body);
    syswrite STDOUT, "Perl, $style | $status | $rest\n";
}

sub upload {
    my ($url, $path) = @_;
    my $mesh = read_file($path);
    for my $make (@agent_makers) {
        my ($name, $send, $send_form) = $make->();
        report("$name, whole", $send->($url, $mesh));
        my $offset = 0;
        my $next   = sub {
            my $piece = $offset < length $mesh ? substr($mesh, $offset, 10_000) : '';
            $offset += length $piece;
            return $piece;
        };
        report("$name, stream", $send->($url, $next));
        report("$name, form", $send_form->($url, $path)) if $send_form;
    }
}

# Each connection is a process, since threads are not in every Perl.
sub pause {
    my ($url, $path, $seconds, $rounds, $connections) = @_;
    my $mesh = read_file($path);
    for my $make (@agent_makers) {
        for (1 .. $connections) {
            next if fork;
            my ($name, $send) = $make->();
            for my $round (0 .. $rounds) {
                sleep $seconds if $round > 0;
                report("$name, pause", $send->($url, $mesh));
            }
            exit 0;
        }
    }
    1 while wait > 0;
}

sub early {
    my ($url, $size, $rate) = @_;
    for my $make (@agent_makers) {
        my ($name, $send) = $make->();
        my ($began, $given) = (time, 0);
        my $next = sub {
            my $due = $began + $given / $rate - time;
            sleep $due if $due > 0;
            my $count = $size - $given < 65_536 ? $size - $given : 65_536;
            $given += $count;
            return '#' x $count;
        };
        report("$name, stream", $send->($url, $next));
    }
}

my ($command, @arguments) = @ARGV;
my %commands = (upload => \&upload, pause => \&pause, early => \&early);
$commands{$command}->(@arguments);
