! From Fortran: two cubes that press each other, and ten tetrapods that fall into a box and come to rest. Numbers are checked; the
! program ends with 1 if one is wrong.
program fall
  use femdem
  implicit none
  type(femdem_shape_t) :: cube, tetrapod, none
  type(femdem_pose_t) :: below, above
  type(femdem_pair_t) :: pair
  type(femdem_world_parameters_t) :: parameters
  type(femdem_world_t) :: world
  type(femdem_sides_t) :: sides
  type(femdem_motion_t) :: motion, motions(10)
  type(femdem_load_t) :: load
  type(femdem_ledger_t) :: ledger
  type(femdem_shape_properties_t) :: properties
  integer(c_int32_t) :: body
  integer(c_size_t) :: count
  real(c_double) :: weight
  integer :: k

  call check(femdem_shape_named("cube"//c_null_char, sqrt(3d0), 0d0, cube))
  above%position(3) = 0.999d0
  call check(femdem_pair_evaluate(1d6, cube, below, cube, above, pair))
  ! p a delta (1/h_A + 1/h_B) with h = 0.5 m, less the rim.
  call expect(abs(pair%on_b%force(3) / 4000d0 - 1) < 0.003d0, "force of the pair")
  print '(a, f9.3, a)', "pair: ", pair%on_b%force(3), " N"

  call check(femdem_world_defaults(parameters))
  call check(femdem_world_new(parameters, world))
  call check(femdem_world_add_box(world, femdem_box_t([0d0, 0d0, 0d0], [0.3d0, 0.3d0, 3d0]), 0, sides))
  call check(femdem_shape_named("tetrapod"//c_null_char, 0.1d0, 0d0, tetrapod))
  do k = 1, 10
    motion%pose%position = [0.15d0, 0.15d0, 0.13d0 * k]
    call check(femdem_world_add_body(world, tetrapod, 2400d0, motion, 0, body))
  end do
  call check(femdem_world_step_until(world, 2.5d0))
  call check(femdem_world_motions(world, motions, size(motions, kind=c_size_t), count))
  call expect(count == 10 .and. body == 9, "ten bodies")
  call expect(all(abs(motions%velocity%linear(3)) < 0.05d0), "all at rest")
  call check(femdem_shape_properties(tetrapod, properties))
  weight = 10 * 2400 * properties%volume * 9.81d0
  call check(femdem_world_wall_load(world, sides%low(3), load))
  call expect(abs(-load%force(3) / weight - 1) < 0.15d0, "the floor bears the weight")
  call check(femdem_world_ledger(world, ledger))
  call expect(abs(ledger%error_relative) < 0.02d0, "energy of the world")
  print '(a, f7.2, a, f7.2, a)', "world: the floor bears ", -load%force(3), " N of ", weight, " N"

  ! What is wrong is a status with words.
  call expect(femdem_shape_named("no such shape"//c_null_char, 1d0, 0d0, none) == FEMDEM_STATUS_REFUSED, "a refusal")
  call expect(len(femdem_message()) > 0, "its words")
  call check(femdem_world_free(world))
  call check(femdem_shape_free(cube))
  call check(femdem_shape_free(tetrapod))

contains

  subroutine check(status)
    integer(c_int), intent(in) :: status
    if (status /= FEMDEM_STATUS_OK) then
      print '(a)', femdem_message()
      stop 1
    end if
  end subroutine

  subroutine expect(right, what)
    logical, intent(in) :: right
    character(*), intent(in) :: what
    if (.not. right) then
      print '(2a)', "wrong: ", what
      stop 1
    end if
  end subroutine
end program
