// Every threshold that decides what a diagnosis accepts, refuses, names or doubts, in the way that a
// recording goes, each with its reason. Where no reason follows, the value is a choice that no measurement
// stands behind. Grids, filters and numbers of draws stand where they are used;
// tools/recordings/reading_limits.hpp judges single rows, and the home of each effect has its ranges.
#pragma once

#include <cstddef>

namespace patella::diagnose {

/// Can the recording be analysed at all?
namespace readable {
/// Rows of a recording in motion: the shortest stretch at 100 Hz.
inline constexpr std::size_t kFewestRows = 200;
/// Postures of a recording at rest.
inline constexpr std::size_t kFewestPostures = 10;
/// Length of a stretch without a gap; shorter ones are left out.
inline constexpr double kShortest_s = 2.0;
/// Share of the sampling rate up to which central differences and the smoothing before them leave the motion
/// as it was: the analysis band ends there, and slower recordings of a motion are refused.
inline constexpr double kBandShareOfRate = 0.15;
}  // namespace readable

/// Which units, signs, order, zeros and clocks do the columns have?
// A hypothesis is a way to read the recording. Its misfit is what the model, within what is known of its
// masses, and rubbing leave of each joint's load.
namespace convention {
/// Relative tolerance of the model's parameters: what people know of masses and their places.
inline constexpr double kOwnRange = 0.3;
/// Factor by which a model of another leg, or one with a payload, may be wrong: that is no convention. A
/// torque that is wrong by more is in another unit.
inline constexpr double kOtherLeg = 2.5;
/// Share of a joint's load that the best models of machines leave: less counts as this much.
inline constexpr double kFloor = 0.05;
/// Share of a joint's load: more than this left is out of proportion for a model of the machine. A joint that
/// leaves no more as given speaks for a convention only by kSmallPart, or by leaving less than plain effects
/// do.
inline constexpr double kOutOfProportion = 0.2;
/// The same from which on two conventions at once are looked for: each of them puts the model out of
/// proportion.
inline constexpr double kFarOff = 0.4;
/// Range of a joint within which gravity is a straight line to a per cent, (1/4)²/6: zeros, units and a
/// spring look alike there, so that two conventions at once are not told.
inline constexpr double kLeastBend_rad = 0.5;
/// Share of the load that machines leave of their models. A convention may leave as much on each joint that
/// it changes; where it leaves more, kSmallPart decides. A torque that is scaled has to gain on plain effects
/// beside this floor.
inline constexpr double kAsMachines = 0.15;
/// Share of what the recording as given leaves: chance does not bring a joint below it.
inline constexpr double kSmallPart = 0.4;
/// Share of what the recording as given leaves, both beside kFloor: a joint that speaks for a convention has
/// to leave less where no more than kOutOfProportion was left, and a torque that is scaled less of itself.
inline constexpr double kSpeaks = 0.5;
/// Share of what the recording as given leaves that a convention may leave, on the mean of the joints. The
/// same share of what plain effects leave of a joint.
inline constexpr double kFarBetter = 0.75;
/// Share that a convention gains, in logarithms, of what effects gain on the recording as given: effects have
/// several numbers for each joint, a convention has one at most.
inline constexpr double kOfEffects = 0.75;
/// Multiple of what effects leave that a convention may leave, on the mean of the joints: a spring that looks
/// like a zero looks like it in a part of the motion only.
inline constexpr double kTimesEffects = 5.0;
/// Share of the load that good sensors leave of a machine that is known to the last.
inline constexpr double kSensors = 0.003;
/// Multiple of what the best convention leaves: another one that leaves no more is as good, and both are
/// named.
inline constexpr double kAsGood = 1.25;
/// The same on the mean of the joints, for one that leaves no more than machines leave on any: what is left
/// is then the machine's, and tells conventions apart less well.
inline constexpr double kAsGoodOfMachines = 1.75;
/// Share of a joint's range on which its friction comes up after a reversal. It is late then, as a torque
/// column may be. A mixture of it and of dry friction has the shape of any friction that comes up earlier.
inline constexpr double kPreslidingShare = 0.01;
/// The same of springs in a drive's way to the joint, such as cables and contacts of grease.
inline constexpr double kSlowPreslidingShare = 0.1;
/// Multiple of the inertia that a joint moves up to which a motor's is a plain effect: gears are chosen so
/// that the two are about alike, and what is more would explain a torque in another unit.
inline constexpr double kMostMotor = 5.0;
/// Gears of drives for joints end here.
inline constexpr double kLargestGear = 250.0;
/// An encoder's offset is less: it is an effect.
inline constexpr double kLeastZero_rad = 0.15;
/// Zeros this near to each other have the same name.
inline constexpr double kSameZero_rad = 0.15;
/// Samples and filters shift a column by less.
inline constexpr double kLeastShift_s = 0.015;
/// Drives act within this time. A torque that comes early by less is a late drive's, which is an effect.
inline constexpr double kSlowDrive_s = 0.03;
/// Columns that are farther apart are of two recordings.
inline constexpr double kFarthestShift_s = 0.25;
/// Two turns: most joints end before.
inline constexpr double kLargestAngle_rad = 12.566;
}  // namespace convention

/// Did the torque act at its sample, where the form of the file says that it was held?
// A torque that was held acts half a period of the samples later, one that acted before its sample earlier.
namespace torque_timing {
/// Share of a torque's rms at which it counts as turned round, for play.
inline constexpr double kTurned = 0.2;
/// Standard deviation, in half periods, up to which a joint has a vote.
inline constexpr double kTells = 0.45;
/// Half periods between a joint's estimate and the nearest of three answers: held, which is none early,
/// sampled, which is one, and since the sample before, which is two. What is farther from all comes early or
/// late by something else.
inline constexpr double kNear = 0.5;
/// Standard deviations by which all votes together have to contradict a held torque.
inline constexpr double kSure = 2.0;
/// The same by which each of two joints has to contradict the other's answer: there are many pairs of joints.
inline constexpr double kContradicts = 3.0;
}  // namespace torque_timing

/// Is the motion, or the torque, enough to tell?
namespace motion {
/// Velocity (rms) below which a joint is at rest.
inline constexpr double kLeastVelocity_rad_s = 1e-3;
/// Share of the fastest joint's velocity below which a joint rests and shakes with the other.
inline constexpr double kLeastShareOfOther = 0.01;
/// Steps of the encoder, or rms of its noise, that a joint that moves goes beyond.
inline constexpr double kLeastSteps = 5.0;
/// Range of the postures of a joint that was brought to several.
inline constexpr double kLeastPostures_rad = 1e-3;
/// Share of its load below which a joint is not driven: the torque column is a sensor's zero.
inline constexpr double kDriven = 0.05;
/// Times as many rows at the largest torque as at the next value: the torque is cut off there.
inline constexpr std::size_t kPileUp = 5;
/// Share of rows with a torque that is cut off: above, nothing is diagnosed …
inline constexpr double kMostClipped = 0.05;
/// … above, a warning.
inline constexpr double kLeastClipped = 0.002;
/// Share of a joint's inertial torque that plain effects may fail to explain where the torque never changes:
/// a leg that is let go swings by itself, but no leg that is driven.
inline constexpr double kFreeSwing = 0.25;
/// Share of its torque that the model may fail to explain on a joint at rest.
inline constexpr double kRestExplained = 0.5;
/// Share of a velocity's power in one line: above, a single sinusoid excites the joint.
inline constexpr double kSingleLine = 0.97;
/// Share by which the lines of two recordings may differ and be one.
inline constexpr double kSameFrequency = 0.05;
/// Share of the effects looked for on a joint that do not show: above, the joint tells next to nothing.
inline constexpr double kNearlyAll = 0.75;
/// Plain effects should show from this multiple of the noise on, or from unknown::kRestOfNothing of a joint's
/// torque where that is more …
inline constexpr double kPlainStrength = 3.0;
/// … and share of the plain effects that may not, where nothing was found.
inline constexpr double kMostPlainUnseen = 0.5;
/// Share of its tolerance to which the recording narrows a nominal parameter that it identifies.
inline constexpr double kNarrowed = 0.8;
}  // namespace motion

/// Does a joint at rest say anything of the machine?
// While dry friction holds, the drive's torque is anything up to friction's level. Where a person pushes, the
// motion is hers.
namespace resting {
/// Time for which a joint stays where it is, to be at rest: a pause of a motion is longer.
inline constexpr double kPause_s = 0.5;
/// Share of its speed (rms) with which a joint may drift in that time, and rest: encoders' steps stay below.
inline constexpr double kPauseDrift = 0.02;
/// The same of a joint that friction holds where it turns round. A sinusoid stays no longer from 0.03 Hz on.
inline constexpr double kTurn_s = 0.2;
inline constexpr double kTurnDrift = 0.005;
/// The same of a joint that a person pushes, who moves it where it is held: by hundredths of a radian, to and
/// fro. A sinusoid stays no longer from 0.11 Hz on.
inline constexpr double kPushedPause_s = 1.0;
inline constexpr double kPushedDrift = 0.125;
/// Share of the time for which such a joint rests, where its motion has pauses. Motions without any stay so
/// for a tenth of the time, where they turn round slowly.
inline constexpr double kPushedLeast = 0.25;
/// Time in which the rows of a motion come up after a rest: the band would spread what comes up at once.
inline constexpr double kTaper_s = 0.1;
/// What is left between two rests is used from this length on: noise of its own shows in no less.
inline constexpr double kShortestRun_s = 0.4;
/// Multiple of what plain effects leave in motion that they have to leave at rest: what they leave of a real
/// machine's friction is no less where it turns round.
inline constexpr double kTimesMotion = 2.0;
/// Multiple of the dry friction that a joint shows in motion up to which friction may hold it at rest: the
/// level at which machines break away is up to twice that of motion.
inline constexpr double kTimesLevel = 2.0;
/// The same that has to be left at rest: a torque anywhere between friction's levels is 0.58 of them (rms),
/// and what a joint leaves that creeps to its place and rests there without friction is less.
inline constexpr double kLeastOfLevel = 0.3;
/// Share of a joint's load (rms) that plain effects have to leave at rest.
inline constexpr double kLeastOfLoad = 0.01;
/// Share of the rows that has to be left.
inline constexpr double kLeastLeft = 0.15;
}  // namespace resting

/// Is a step of the search accepted?
namespace accepted {
/// Probability, over all candidates together, that chance brings a step; below it a step is accepted.
inline constexpr double kFamilyWiseP = 0.005;
/// Rows that follow each other closely count once in so many at most. While something is missing, the noise
/// of a fit holds it too and looks slower than it is.
inline constexpr double kLargestRedundancy = 12.0;
/// Multiple of the variance that chance brings. The variance of a sum of products of two Gaussian processes
/// is at most twice as large where they go together (Isserlis); what varies more is something missing that
/// shows here and there, such as a contact.
inline constexpr double kMostByMotion = 2.0;
/// Share of the best fit so far that a candidate's columns have to explain for it to be fitted.
inline constexpr double kNearBest = 0.3;
/// Share of a column's square that other effects may fail to give, and still be said to give it. Two signs of
/// a velocity that are smoothed differently stay below; a friction with a shape of its own does not.
inline constexpr double kRepeated = 2e-3;
/// Share of the residual: a coefficient whose torque is less is zero.
inline constexpr double kNextToNothing = 1e-3;
/// Squared standard deviations from which on data contradict what is said of a parameter: three of them. A
/// coefficient that physics keeps at zero would have to be negative; slow motion denies a drive's delay.
inline constexpr double kContradicted = 9.0;
/// Share of a range within which a parameter stands at its end: it is out of what its equation means.
inline constexpr double kNearBound = 0.02;
/// Share of the mean square that is left of a joint's torque that an effect has to explain: less is nothing
/// that anyone would miss, however sure it is.
inline constexpr double kLeastShare = 0.03;
/// Share of a joint's load (rms) that an effect has to act with. Gravity alone differs by half a percent
/// between places: nobody knows a machine better, and nobody misses less.
inline constexpr double kLeastOfLoad = 0.002;
/// The share of the mean square of a tremor below kClearLine. A person who walks or swings a leg pushes in a
/// spectrum that has humps, which drawn noise does not have.
inline constexpr double kLeastTremorShare = 0.15;
/// Gain of a tremor, in units of chance, from which on it is a line.
inline constexpr double kClearLine = 100.0;
/// Squared standard deviations by which what is known beforehand, masses or declared damping, has made up
/// for an effect: two of them. The effect then matters, however little it leaves to explain.
inline constexpr double kMoved = 4.0;
/// Correlation ρ of what two joints leave from which on the search looks at them one by one, too: beside each
/// other, an effect that both lack alike keeps (1 − ρ)/(1 + ρ) of its evidence, a twentieth.
inline constexpr double kJointsAlike = 0.9;
/// Standard errors by which the gain on unseen blocks has to be positive.
inline constexpr double kCrossValidationErrors = 1.5;
/// Share of block bootstraps in which a step has to gain more than its parameters cost.
inline constexpr double kLeastStability = 0.8;
/// By how many times its margin a candidate must be the clearer one, to be tried where the best was refused.
inline constexpr double kClearer = 3.0;
}  // namespace accepted

/// Does fast motion show a drive that is late?
namespace late_drive {
/// Share of a drive's torque that may be left unexplained. A controller answers what pushes the machine, a
/// patient or a contact, and its answer passes for a late drive: both let torque follow on motion. Where
/// little pushes, little is answered.
inline constexpr double kUndisturbed = 0.05;
/// Share of the torque between the lines of its spectrum that may be left unexplained for all of it to be the
/// motion's: twice as much as any push in it.
inline constexpr double kExplainedBetween = 0.5;
/// Share of the square of what is left that the delay has to explain. The noise of fast motion is known less
/// well than the tests suppose.
inline constexpr double kMaterial = 0.05;
/// Share of the held-out error that a delay may leave.
inline constexpr double kShows = 0.99;
/// Periods of the recording that a drive has to be late, or its delay is not asserted. When within a period
/// the columns of a row were read is hardly ever known: what is less may as well be the reader's.
inline constexpr double kLeastPeriods = 0.5;
}  // namespace late_drive

/// Would a simpler effect say the same?
namespace simpler {
/// −2 log posterior, in units of chance, that is as good as equal.
inline constexpr double kAsGood = 0.1;
/// Share of what an effect explains that a simple one may leave where the effect is out of its range.
inline constexpr double kRest = 0.1;
/// Standard deviations by which two levels of friction differ, if they are two: as wide as the intervals that
/// the user is shown.
inline constexpr double kTwoLevels = 2.5;
}  // namespace simpler

/// Which other effects could it be?
namespace rivals {
/// Share of what the found effect's columns explain that a rival's have to, for it to be fitted.
inline constexpr double kNear = 0.35;
/// −2 log posterior within which two effects explain the data equally well. By more than that, the held-out
/// part puts one before the other.
inline constexpr double kMargin = 6.0;
/// As kMargin, of the fit alone: more parameters do not make a rival worse, as its physics may have fixed
/// them.
inline constexpr double kAsWell = 2.7;
/// The same as a share of what was found explains: where that is much, small faults of any model, which grow
/// with it, count for more than noise.
inline constexpr double kNoDifference = 0.005;
/// The same for shapes that are much alike: four standard deviations. Real machines have a little of both of
/// two such effects, and a ripple of few periods is much like a spring that bends. By as much, the held-out
/// part excludes what is not alike.
inline constexpr double kAlike = 16.0;
/// −2 log likelihood for each parameter that an effect has beyond one that it contains, and so explains as
/// much as always: one in twenty explains more by chance.
inline constexpr double kNestedEvidence = 3.84;
/// Akaike's criterion: a rival so much behind another has less than a seventh of its support.
inline constexpr double kPredictsLess = 4.0;
/// Share of a found torque by which one that contains it may differ within kWithin95, and the found one still
/// be the only answer.
inline constexpr double kMaterialDoubt = 0.25;
/// Standard deviations of a 95 % interval, rounded.
inline constexpr double kWithin95 = 2.0;
/// Share of what Stribeck's friction, or dry friction beside a bias, explains from which on dry friction, of
/// one level or of two, may be all there is: they differ near rest only.
inline constexpr double kNearlyAll = 0.85;
}  // namespace rivals

/// Does what was found hold?
namespace held_out {
/// Share of the held-out error below which leaving a term out is better.
inline constexpr double kSmaller = 0.998;
/// Half of an interval over the value itself, or the logarithm of a factor: above, a parameter is unknown,
/// and a term of which nothing is known is dropped.
inline constexpr double kUnknown = 10.0;
/// Held-out error of a joint after over before: above, a warning; less is within the noise.
inline constexpr double kCost = 1.05;
/// Held-out error over noise floor: above, something else happens in the held-out part, unless both are as
/// small shares of the torque.
inline constexpr double kOutOfProportion = 2.5;
/// Share of what the effects that were found take away there, up to which it may as well be that nature's
/// effect is not quite the library's: dry friction leaves a tenth of itself where it is held.
inline constexpr double kLittleOfFound = 0.2;
}  // namespace held_out

/// Do the recordings contradict each other?
namespace contradiction {
/// Probability below which a difference between recordings is no chance …
inline constexpr double kSignificant = 1e-3;
/// … and the standard deviations that belong to it, for a normal distribution.
inline constexpr double kDeviations999 = 3.2905;
/// Share of its strength by which an effect has to differ between recordings to matter.
inline constexpr double kMaterialShare = 0.5;
/// Share of the squared error of a common fit: fits of each recording alone that leave more are of one
/// machine.
inline constexpr double kSameMachine = 0.7;
}  // namespace contradiction

/// Is a line in the spectrum a tremor?
namespace tremor {
/// The band in which tremors are looked for.
inline constexpr double kLowest_Hz = 3.0;
inline constexpr double kHighest_Hz = 12.0;
/// Stretches of four seconds that a spectrum needs.
inline constexpr double kFewestStretches = 6.0;
/// Probability, over all lines together, that chance brings one.
inline constexpr double kSignificant = 1e-6;
/// Share of a line's power above its neighbourhood that may stand beside it. A control loop that a late drive
/// makes ring has a hump in its spectrum; a tremor's line has no such shoulders.
inline constexpr double kShoulder = 0.04;
/// How far from the line its shoulders are looked for.
inline constexpr double kShoulder_Hz = 1.1;
/// Standard deviations by which chance may raise a shoulder.
inline constexpr double kChance = 3.0;
/// Amplitude over the residual (rms).
inline constexpr double kLeast = 0.35;
/// Share of a velocity's power in one line: above, it is a part of the motion, which a column that is shifted
/// leaves a line of as well.
inline constexpr double kOfMotion = 0.1;
}  // namespace tremor

/// Is an effect asserted, or only possible?
namespace asserted {
/// Torque that an effect has to explain by itself, over what is left of its joint's torque beyond noise
/// (rms). An effect of so many times the rest comes up by chance in 1.6e-4 (likelihood ratio of 6 ln(1
/// + 1.5²) nats, chi-squared of one degree of freedom), any of 22 kinds on two joints in 0.7 %.
inline constexpr double kOverRest = 1.5;
/// What is left of a joint's torque beyond noise has a shape of its own, as long as the motion, so that a
/// recording is about so many independent looks at it, however many rows it has.
inline constexpr double kLooks = 12.0;
/// Periods over the joint's range from which on a ripple is told from a bend, which any function of position
/// could be.
inline constexpr double kPlainCycles = 2.5;
/// Standard deviations over persons from which on a published slope is none any more.
inline constexpr double kAnotherSlope = 1.25;
/// Factor by which intervals are wider than bootstrap and jackknife say, which do not see that nature's
/// effect is not quite the library's: real stiction has no smooth curve. Their 95 % intervals held the truth
/// in 179 of 197 parameters (patella-bench-diagnose, seeds 106 to 108); so much wider they hold it in 185. An
/// effect whose interval holds zero is not asserted.
inline constexpr double kShapeAllowance = 1.3;
}  // namespace asserted

/// Is what is left unknown?
namespace unknown {
/// Share of a joint's torque (rms) that a model may leave beyond noise and still be said to lack nothing but
/// what was found: machines leave a tenth to a fifth with the best model of them.
inline constexpr double kMaterialRest = 0.2;
/// The same where nothing was found: what is missing there has to be small, as whoever reads "nothing is
/// missing" looks no further. A load that is grasped and released again and again leaves a tenth and no
/// function that would be seen.
inline constexpr double kRestOfNothing = 0.05;
/// Share of what was found, above which what is left beyond it makes the answer unknown: of what is missing
/// more than a fifth, in squares, has no name then and so may be the effect that was taken for another.
inline constexpr double kShareOfFound = 0.5;
/// Share of a joint's load (rms) from which on what has no name, or is only possible, makes an answer
/// unknown. Gravity differs by as much between places. What is named by its physics needs less
/// (accepted::kLeastOfLoad).
inline constexpr double kLeastOfLoad = 0.005;
/// Share of the square of what is missing from which on one cause of several joints is said to be behind it.
inline constexpr double kGoesWith = 0.9;
/// Multiple of what sensors and declared pushes make up to which what is left beyond it is called noise.
inline constexpr double kLikeNoise = 2.0;
/// Multiple of the declared variance that a person's pushes may have in one recording.
inline constexpr double kPush = 2.0;
/// Multiple of accepted::kFamilyWiseP for a dependence behind named effects. Where nothing was named it would
/// overturn "nothing is missing", which has to be rare; here it only makes an answer more careful.
inline constexpr double kLevelBehindNamed = 2.0;
/// Share of the level that functions which swing with time get: there are many of them, and a person's pushes
/// come and go, too.
inline constexpr double kShareOfSwings = 0.3;
/// Probability by the noise of the fit up to which it pays to look again.
inline constexpr double kWorthASecondLook = 0.2;
/// Share of the level that the second look gets: whoever looks twice has two chances to be wrong.
inline constexpr double kLevelOfSecondLook = 0.5;
/// Correlation of what two joints leave from which on they are looked at one by one, too: a function on one
/// of them, of a torque that both have, keeps (1 − ρ)/(1 + ρ) of its evidence beside the other.
inline constexpr double kJointsAlike = 0.5;
/// Share of the torque that the model lacks that a smooth function must find behind the named effects for all
/// to be called unknown. Below, it may as well be that nature's effect is not quite the library's, or that a
/// person's push goes with the motion.
inline constexpr double kShare = 0.2;
/// Less suffices where the function finds kNoNoise of what is left behind the named effects: such a rest is
/// no noise. On measured data, whose friction is not quite the library's, it stays below 2 % of the missing
/// torque.
inline constexpr double kShareOfNoNoise = 0.05;
/// Share of what is left from which on a function of it is no noise.
inline constexpr double kNoNoise = 1.0 / 3.0;
}  // namespace unknown

/// Is one cause behind what several joints lack?
namespace shared {
/// Share of the squares of what is left from which on it pays to look with the cause taken out, and of which
/// it has to be rid. Late columns explained up to 0.27 of what measured machines left that have none.
inline constexpr double kSuspected = 0.5;
/// Multiple of what effects leave up to which a cause leaves as little.
inline constexpr double kAsLittle = 1.05;
/// Share of the torque (rms on a joint) of a cause that its estimate may leave: filters of one bandwidth are
/// taken for a delay. An effect that explains less may be no more than that.
inline constexpr double kLeftOfCause = 0.05;
}  // namespace shared

/// What would have shown?
namespace shown {
/// Standard deviations that a torque has to lie above the threshold for four in five recordings to show it.
inline constexpr double kFourInFive = 0.84;
/// Standard deviations beyond which a given parameter is taken for free: it is a logarithm, which costs less
/// and less the farther it goes, and takes up more than a slope at its given value says.
inline constexpr double kFarFromGiven = 3.0;
/// Fall of −2 log-likelihood, less the cost of a parameter, that chance is held against where no step of the
/// search drew one.
inline constexpr double kTypicalChance = 10.0;
}  // namespace shown

/// Is a parameter a runaway?
namespace runaway {
/// Standard deviation, relative, of nominal and declared parameters, unless the user says another.
inline constexpr double kTolerance = 0.10;
/// Standard deviations by which a parameter may move within its tolerance.
inline constexpr double kWithinTolerance = 2.0;
/// Share of an interval's half, or of a bound: nearer than this a value stands at the bound.
inline constexpr double kTouches = 1e-3;
/// Share of its declared strength below which an effect has vanished.
inline constexpr double kNothingLeft = 0.01;
/// Error over torque from which on the drives rested, so that there is nothing to compare.
inline constexpr double kNoTorque = 1e4;
/// Share of the error of the model as given that its parameters may leave, moved within their tolerances,
/// before that is said: more than half of it was theirs.
inline constexpr double kTookUp = 0.5;
}  // namespace runaway

}  // namespace patella::diagnose
