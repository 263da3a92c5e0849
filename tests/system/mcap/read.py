"""Counts the messages of an MCAP file by topic, as MCAP's own reader finds them; those in JSON must fit their schema."""

import collections
import json
import sys

import fastjsonschema
from mcap.reader import make_reader

counts, checks = collections.Counter(), {}
with open(sys.argv[1], "rb") as file:
    for schema, channel, message in make_reader(file, validate_crcs=True).iter_messages():
        counts[channel.topic] += 1
        if channel.message_encoding == "json":
            if schema.id not in checks:
                checks[schema.id] = fastjsonschema.compile(json.loads(schema.data))
            checks[schema.id](json.loads(message.data))
json.dump(counts, sys.stdout)
