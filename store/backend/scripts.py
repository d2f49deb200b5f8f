"""The steps that must not be torn apart, as Lua scripts that the server runs in one go."""

MOVE = """
-- Compare-and-set of a job's state, its event in the same step.
-- KEYS: record, problem, result, report, events, live
-- ARGV: id, to, expected (",a,b,"), token, token afterwards, terminal, message, counter,
--       retention, memory, events limit, channel, then field, value, ...
local record, events, live = KEYS[1], KEYS[5], KEYS[6]
local to, token, after, terminal = ARGV[2], ARGV[4], ARGV[5], ARGV[6] == '1'
local status = redis.call('HGET', record, 'status')
if not status then return 0 end
local now = redis.call('HGET', record, 'token') or ''
-- A retry of a move whose reply was lost finds its work done.
if after ~= '' and status == to and now == after then return 1 end
if not string.find(ARGV[3], ',' .. status .. ',', 1, true) then return 0 end
if token ~= '' and now ~= token then return 0 end
redis.call('HSET', record, 'status', to, unpack(ARGV, 13))
if ARGV[8] ~= '' then redis.call('HINCRBY', record, ARGV[8], 1) end
local event = cjson.encode({type = 'state', status = to, terminal = terminal,
  attempt = tonumber(redis.call('HGET', record, 'attempts') or 0), message = ARGV[7]})
redis.call('XADD', events, 'MAXLEN', '~', ARGV[11], '*', 'event', event)
redis.call('PUBLISH', ARGV[12], ARGV[1])
if terminal then
  redis.call('SREM', live, ARGV[1])
  for i = 3, 5 do redis.call('EXPIRE', KEYS[i], ARGV[9]) end
  for i = 1, 2 do redis.call('EXPIRE', KEYS[i], ARGV[10]) end
end
return 1
"""

UPDATE = """
-- Fields of the live attempt; 1 if it should go on. KEYS: record. ARGV: token, field, value, ...
local status = redis.call('HGET', KEYS[1], 'status')
if status ~= 'running' and status ~= 'cancelling' then return 0 end
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[1] then return 0 end
redis.call('HSET', KEYS[1], unpack(ARGV, 2))
if status == 'cancelling' then return 0 end
return 1
"""

PUT = """
-- The result of the live attempt. KEYS: record, result. ARGV: token, result
local status = redis.call('HGET', KEYS[1], 'status')
if status ~= 'running' and status ~= 'cancelling' then return 0 end
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[1] then return 0 end
redis.call('SET', KEYS[2], ARGV[2])
redis.call('HSET', KEYS[1], 'has_result', '1')
return 1
"""

PUT_REPORT = """
-- The report of an ended job; it goes when the result goes, which has its time set by then.
-- KEYS: record, result, report. ARGV: token, report
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[1] then return 0 end
local left = redis.call('PTTL', KEYS[2])
if left <= 0 then return 0 end
redis.call('SET', KEYS[3], ARGV[2], 'PX', left)
return 1
"""

APPEND = """
-- Events of the live attempt. KEYS: record, events. ARGV: id, token, limit, channel, event, ...
local status = redis.call('HGET', KEYS[1], 'status')
if status ~= 'running' and status ~= 'cancelling' then return 0 end
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[2] then return 0 end
for i = 5, #ARGV do
  redis.call('XADD', KEYS[2], 'MAXLEN', '~', ARGV[3], '*', 'event', ARGV[i])
end
redis.call('PUBLISH', ARGV[4], ARGV[1])
return 1
"""

BEGIN_POINT = """
-- Count one more beginning of a point by the live attempt.
-- KEYS: job's record, begun, sweep's record. ARGV: token, index
local status = redis.call('HGET', KEYS[1], 'status')
if status ~= 'running' and status ~= 'cancelling' then return 0 end
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[1] then return 0 end
if redis.call('EXISTS', KEYS[3]) == 0 then return 0 end
return redis.call('HINCRBY', KEYS[2], ARGV[2], 1)
"""

END_POINT = """
-- The end of a point, once: its outcome, result and event.
-- KEYS: job's record, job's events, result, ended, begun, sweep's record, plan
-- ARGV: job's id, token, index, outcome, result or '', event, events limit, channel, retention,
--       memory
local status = redis.call('HGET', KEYS[1], 'status')
if status ~= 'running' and status ~= 'cancelling' then return 0 end
if redis.call('HGET', KEYS[1], 'token') ~= ARGV[2] then return 0 end
if redis.call('EXISTS', KEYS[6]) == 0 then return 0 end
-- A retry of a call whose reply was lost finds its work done.
if redis.call('HSETNX', KEYS[4], ARGV[3], ARGV[4]) == 0 then return 1 end
if ARGV[5] ~= '' then redis.call('SET', KEYS[3], ARGV[5], 'EX', ARGV[9]) end
redis.call('XADD', KEYS[2], 'MAXLEN', '~', ARGV[7], '*', 'event', ARGV[6])
redis.call('PUBLISH', ARGV[8], ARGV[1])
for i = 4, 7 do redis.call('EXPIRE', KEYS[i], ARGV[10]) end
return 1
"""
